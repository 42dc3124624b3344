#include "runner/calibrate/light_calibrator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/programs/program_file.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kLightTick_us = 20'000;
constexpr std::int64_t kLightRepeat_us = 200'000;
constexpr double kDrive = 7;            // [s]
constexpr double kStand = 1.0;          // [s] for wheels and filters to settle
constexpr double kSettle = 0.15;        // [s] after a light is shown, before readings are used
constexpr double kRead = 0.5;           // [s]
constexpr double kLightTimeout = 3;     // [s] for a light to be shown
constexpr double kSensorOffset = 0.03;  // [m] distance of the light sensors from the axle

/// Straight runs, and turns on the spot to any direction.
/// @param speed [m/s]
Program wandering(double speed, const dynamics::WheelLimits& limits) {
  const std::string text = fmt::format(R"toml(
[phases.run]
forward = "{:.9g} cm/s"
hold = "exponential(1.7 s)"
next = "turn"
[phases.turn]
turn = "uniform(-pi, pi) / 0.6 s"
hold = "0.6 s"
next = "run"
)toml",
                                       speed * 100);
  return toProgram(readProgram(text, "light calibration", "wandering", limits));
}

/// Command that makes all robots wander and turn away from obstacles.
robot_command_t wander(const Experiment& experiment) {
  const double speed = std::min(0.12, 0.45 * experiment.hardware.max_wheel_speed);
  const Program program = wandering(speed, wheelLimits(experiment.hardware));
  robot_command_t command = lightTableCommand(experiment);
  for (robot_order_t& order : command.orders) {
    light_band_t band{};
    band.low = 0;
    band.high = 1;
    band.program = toMessage(program);
    order.bands = {band};
    order.num_bands = 1;
    order.reverse_on = static_cast<std::int8_t>(ReverseOn::kAny);
    order.reverse_distance = 0.1;
    order.reverse_speed = speed;
  }
  return command;
}

}  // namespace

const std::vector<double>& LightCalibrator::levels() {
  static const std::vector<double> levels{0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0};
  return levels;
}

double LightCalibrator::roundTime() {
  return kDrive + kStand + static_cast<double>(levels().size()) * (kSettle + kRead + 0.1);
}

LightCalibrator::LightCalibrator(const ServiceContext& context, ExperimentController& controller,
                                 int rounds, std::vector<calibration::LightSample>& samples,
                                 std::function<void(int round)> tell, std::function<void()> done)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      controller_(controller),
      rounds_(rounds),
      samples_(samples),
      tell_(std::move(tell)),
      done_(std::move(done)) {
  light_.priority = light_command_t::MANUAL;
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                   [this](const tracked_frame_t& frame) { take(frame); });
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { take(status); });
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { take(status); });
  loop_.every(kLightTick_us, loop_.now() + kLightTick_us, [this] { tick(); });
}

void LightCalibrator::take(const tracked_frame_t& frame) {
  // A camera sees no robot in the dark, but robots do not move then, so their last poses are valid.
  if (phase_ != Phase::kStand && phase_ != Phase::kShow) return;
  if (frame.utime < since_ && phase_ == Phase::kStand) return;
  constexpr float kMinConfidence = 0.5F;
  for (const tracked_pose_t& pose : frame.robots) {
    if (pose.confidence >= kMinConfidence) stands_[pose.robot_id] = {pose.x, pose.y, pose.theta};
  }
}

void LightCalibrator::take(const light_status_t& status) {
  const NodeIdentity& own = node_.identity();
  const bool own_light = status.commander == own.name && status.command_instance == own.instance &&
                         status.command_seq == light_.seq;
  if (phase_ == Phase::kShow && own_light && shown_ == 0) shown_ = status.first_shown_utime;
}

void LightCalibrator::take(const robot_status_t& status) {
  if (phase_ != Phase::kShow || shown_ == 0) return;
  for (const robot_state_t& robot : status.robots) {
    if (robot.utime < shown_ + units::microseconds(kSettle)) continue;
    Readings& readings = readings_[robot.robot_id];
    ++readings.count;
    const double both[2] = {static_cast<double>(robot.light_front),
                            static_cast<double>(robot.light_back)};
    for (int i = 0; i < 2; ++i) {
      readings.sum[i] += both[i];
      readings.square[i] += both[i] * both[i];
    }
  }
}

void LightCalibrator::enter(Phase phase) {
  phase_ = phase;
  since_ = loop_.now();
}

void LightCalibrator::tick() {
  const double waited = units::seconds(loop_.now() - since_);
  if (light_.seq > 0 && loop_.now() >= next_light_) sendLight();
  switch (phase_) {
    case Phase::kBoot:
      if (controller_.inScript()) drive();
      return;
    case Phase::kDrive:
      if (waited < kDrive) return;
      controller_.command(standCommand(experiment_));
      stands_.clear();
      enter(Phase::kStand);
      return;
    case Phase::kStand:
      if (waited < kStand) return;
      level_ = 0;
      showLevel();
      return;
    case Phase::kShow: {
      const bool read = shown_ != 0 && loop_.now() > shown_ + units::microseconds(kSettle + kRead);
      if (!read && waited < kLightTimeout) return;
      keepLevel();
      if (++level_ < levels().size()) {
        showLevel();
        return;
      }
      tell_(++round_);
      if (round_ < rounds_) {
        drive();
        return;
      }
      enter(Phase::kDone);
      done_();
      return;
    }
    case Phase::kDone:
      return;
  }
}

/// Starts to drive, under light so that a camera sees the robots.
void LightCalibrator::drive() {
  light::Layer uniform;
  uniform.intensity = 1;
  ++light_.seq;
  setLayers(light_, {{uniform, {}}});
  sendLight();
  controller_.command(wander(experiment_));
  enter(Phase::kDrive);
}

void LightCalibrator::showLevel() {
  light::Layer uniform;
  uniform.intensity = levels()[level_];
  ++light_.seq;
  light_.label = "staircase";
  setLayers(light_, {{uniform, {}}});
  shown_ = 0;
  readings_.clear();
  enter(Phase::kShow);
  sendLight();
}

void LightCalibrator::keepLevel() {
  for (const auto& [id, readings] : readings_) {
    const auto stand = stands_.find(id);
    if (stand == stands_.end() || readings.count < 2) continue;
    const double n = readings.count;
    for (int i = 0; i < 2; ++i) {
      const double offset = i == 0 ? kSensorOffset : -kSensorOffset;
      const double mean = readings.sum[i] / n;
      const double variance = std::max(0.0, readings.square[i] / n - mean * mean) / (n - 1);
      samples_.push_back({{id, i == 0},
                          {stand->second.x + offset * std::cos(stand->second.theta),
                           stand->second.y + offset * std::sin(stand->second.theta)},
                          levels()[level_],
                          mean,
                          std::sqrt(variance)});
    }
  }
}

void LightCalibrator::sendLight() {
  next_light_ = loop_.now() + kLightRepeat_us;
  light_.utime = 0;
  node_.publishCommand(channels::kLightCommand, light_);
}

}  // namespace lab::runner
