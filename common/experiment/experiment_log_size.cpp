#include "common/experiment/experiment_log_size.hpp"

#include <algorithm>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <string_view>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/programs/hold_rate.hpp"
#include "light/field/image.hpp"

namespace lab {
namespace {

constexpr double kEventHeader = 28;       // bytes of an lcm-logger event before its channel's name
constexpr std::size_t kUsualSender = 10;  // length of a sender's name
constexpr int kUsualLags = 57;            // of the analyzer's curves
constexpr int kUsualEstimates = 8;
constexpr int kCollectiveCurves = 9;
constexpr int kUsualPoints = 38;  // of its curves, on average
constexpr int kUsualObservables = 20;
constexpr double kCommandRate = 5;  // [1/s] ROBOT_COMMAND
constexpr double kLightCommandRate = 2;
constexpr double kLightStatusRate = 10;
constexpr double kTruthRate = 10;
constexpr double kExperimentStatusRate = 2;
constexpr double kStepBytes = 70;       // per draw in ROBOT_STEPS, with its part of the header
constexpr double kHousekeeping = 1500;  // bytes/s of SERVICE_STATUS, EXPERIMENT_EVENT and CLOCK

template <typename Message>
double eventBytes(std::string_view channel, Message message) {
  message.sender.assign(kUsualSender, 'x');
  return kEventHeader + static_cast<double>(channel.size()) + message.getEncodedSize();
}

double frameBytes(std::int32_t robots) {
  tracked_frame_t message{};
  message.num_robots = robots;
  message.robots.resize(static_cast<std::size_t>(robots));
  return eventBytes(channels::kTrackedFrame, message);
}

/// The size of tracker_svc's TRACKED_DETAILS.
double detailsBytes(const Experiment& experiment, std::int32_t robots) {
  if (experiment.camera.tracker != Tracker::kCamera) return 0;
  tracked_details_t message{};
  message.num_caps = robots;
  message.caps.resize(static_cast<std::size_t>(robots));
  return eventBytes(channels::kTrackedDetails, message);
}

double statusBytes(std::int32_t robots) {
  robot_status_t message{};
  message.num_robots = robots;
  message.robots.resize(static_cast<std::size_t>(robots));
  return eventBytes(channels::kRobotStatus, message);
}

double truthBytes(std::int32_t robots) {
  sim_truth_t message{};
  message.num_robots = robots;
  message.robots.resize(static_cast<std::size_t>(robots));
  return eventBytes(channels::kSimTruth, message);
}

double analysisBytes() {
  curve_t curve{};
  curve.num_lags = kUsualLags;
  for (auto* column : {&curve.lag, &curve.value, &curve.sigma, &curve.exact, &curve.paper}) {
    column->resize(kUsualLags);
  }
  curve.windows.resize(kUsualLags);
  curve.biased.resize(kUsualLags);
  analysis_t message{};
  message.num_curves = 2;
  message.curves.assign(2, curve);
  message.num_estimates = kUsualEstimates;
  message.estimates.resize(kUsualEstimates);
  for (estimate_t& estimate : message.estimates) estimate.note.assign(40, 'x');
  return eventBytes(channels::kAnalysis, message);
}

/// Without the robots of the last frame.
double collectiveBytes() {
  observable_curve_t curve{};
  curve.num_points = kUsualPoints;
  for (auto* column : {&curve.x, &curve.value, &curve.low, &curve.high}) {
    column->resize(kUsualPoints);
  }
  collective_t message{};
  message.num_curves = kCollectiveCurves;
  message.curves.assign(kCollectiveCurves, curve);
  message.num_observables = kUsualObservables;
  message.observables.resize(kUsualObservables);
  for (observable_t& number : message.observables) number.name.assign(16, 'x');
  return eventBytes(channels::kCollective, message);
}

template <typename Message>
double lightBytes(std::string_view channel, const LightStep& step) {
  Message message{};
  message.layers = toMessages(step.layers);
  message.num_layers = static_cast<std::int32_t>(message.layers.size());
  return eventBytes(channel, message);
}

/// The size of a LIGHT_STATUS of this step. A layer that follows robots is sent once for each
/// robot, and a trail as a grid.
double lightStatusBytes(const Experiment& experiment, const LightStep& step) {
  double bytes = lightBytes<light_status_t>(channels::kLightStatus, step);
  bool trail = false;
  for (const LayerSpec& layer : step.layers) {
    trail = trail || layer.drive.follow == light::Follow::kTrail;
    if (layer.drive.follow != light::Follow::kRobots) continue;
    const std::size_t robots =
        layer.drive.robots.empty() ? experiment.robots.size() : layer.drive.robots.size();
    bytes += (static_cast<double>(robots) - 1) * toMessage(layer).getEncodedSize();
  }
  return trail ? bytes + light::kMostColumns * light::kMostRows : bytes;
}

bool isDriven(const LightStep& step) {
  return std::ranges::any_of(step.layers,
                             [](const LayerSpec& layer) { return !light::isStill(layer.drive); });
}

/// About the largest number of draws per second that robots on the wire report: all run the program
/// that draws most often.
double stepsPerSecond(const Experiment& experiment) {
  double busiest = 0;
  for (const auto& [name, program] : experiment.programs) {
    busiest = std::max(busiest, holdsPerSecond(program));
  }
  const auto on_wire = std::ranges::count_if(
      experiment.robots, [](const RobotSpec& robot) { return isOnWire(robot.body); });
  return busiest * static_cast<double>(on_wire);
}

}  // namespace

double expectedLogBytes(const Experiment& experiment) {
  const auto robots = static_cast<std::int32_t>(experiment.robots.size());
  double light = 0;
  for (const LightStep& step : experiment.light.steps) {
    const double rate =
        step.ramp > 0 || isDriven(step) ? experiment.light.frame_rate : kLightStatusRate;
    light = std::max(
        light, rate * lightStatusBytes(experiment, step) +
                   kLightCommandRate * lightBytes<light_command_t>(channels::kLightCommand, step));
  }
  const double per_second =
      experiment.camera.fps * (frameBytes(robots) + detailsBytes(experiment, robots)) +
      experiment.hardware.status_rate * statusBytes(robots) + kTruthRate * truthBytes(robots) +
      light + kHousekeeping +
      kExperimentStatusRate * eventBytes(channels::kExperimentStatus, experiment_status_t{}) +
      kCommandRate * eventBytes(channels::kRobotCommand, lightTableCommand(experiment)) +
      (robots + 1.0) * static_cast<double>(experiment.programs.size()) * analysisBytes() +
      (robots > 1 ? static_cast<double>(experiment.programs.size()) + 1 : 0) * collectiveBytes() +
      robots * crowd_member_t{}.getEncodedSize() + stepsPerSecond(experiment) * kStepBytes;
  return experiment.duration * per_second;
}

}  // namespace lab
