#include "runner/campaign/twins/twin_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/math/units.hpp"

namespace lab::runner::campaign {
namespace {

/// The steps of the script in the order in which they were shown, at the recorded times; nothing if
/// it is not known which ones they were.
std::optional<std::vector<LightStep>> shownSteps(const report::TwinFacts& facts) {
  const std::vector<LightStep>& script = facts.experiment.light.steps;
  std::map<std::string, std::size_t> labels;
  std::set<std::string> ambiguous;
  for (std::size_t i = 0; i < script.size(); ++i) {
    if (!labels.emplace(script[i].label, i).second) ambiguous.insert(script[i].label);
  }
  const bool in_order = facts.experiment.light.isPlanned();
  std::vector<LightStep> shown;
  for (const report::RecordedStep& step : facts.steps) {
    std::size_t index = script.size();
    if (in_order) {
      index = static_cast<std::size_t>(step.number) % std::max<std::size_t>(1, script.size());
    } else if (labels.contains(step.label) && !ambiguous.contains(step.label)) {
      index = labels.at(step.label);
    }
    if (index >= script.size()) return {};
    LightStep copy = script[index];
    copy.at = std::round(step.at * 1e6) / 1e6;
    copy.hold = 0;
    copy.until = {};
    copy.back_to.clear();
    copy.times = 0;
    // Labels need not be unique without back_to. A step that a condition ended at once is too short
    // for a file.
    if (!shown.empty() && !isLongEnough(shown.back().at, copy.at)) return {};
    if (copy.at >= facts.duration && !shown.empty()) break;
    shown.push_back(std::move(copy));
  }
  if (shown.empty() || shown.front().at != 0) return {};
  return shown;
}

/// Sets the robots' start poses to the recorded ones, if all are known and allowed.
/// @return whether they are
bool startAsRecorded(Experiment& experiment, const report::TwinFacts& facts) {
  Experiment placed = experiment;
  for (RobotSpec& robot : placed.robots) {
    if (robot.body == Body::kReplay) continue;
    const auto pose = facts.first_poses.find(robot.id);
    if (pose == facts.first_poses.end()) return false;
    // Tracker noise may place a robot into a wall.
    const double radius = placed.hardware.diameter / 2;
    robot.start = StartPose{std::clamp(pose->second.x, radius, placed.arena_width - radius),
                            std::clamp(pose->second.y, radius, placed.arena_height - radius),
                            pose->second.theta};
  }
  try {
    static_cast<void>(parseExperiment(writeExperiment(placed), "twin"));
  } catch (const ExperimentError&) {
    return false;  // robots overlap by the tracker's noise
  }
  experiment = std::move(placed);
  return true;
}

}  // namespace

TwinExperiment twinExperimentOf(const report::TwinFacts& facts) {
  TwinExperiment twin{facts.experiment, {}};
  Experiment& experiment = twin.experiment;
  experiment.duration = std::max(0.001, std::round(facts.duration * 1e6) / 1e6);
  experiment.stop_when.clear();
  experiment.analysis.twins = 0;
  std::string real;
  for (RobotSpec& robot : experiment.robots) {
    if (robot.body == Body::kReplay) continue;
    if (robot.body == Body::kSerial) real += (real.empty() ? "" : ", ") + std::to_string(robot.id);
    robot.body = Body::kSim;
    robot.uid = 0;
  }
  if (!real.empty()) {
    twin.remarks.push_back(fmt::format(
        "Real robots: {}. The twins have simulated bodies with the errors that [robot] states.",
        real));
  }
  const Camera& recorded = facts.experiment.camera;
  if (recorded.tracker == Tracker::kCamera) {
    Camera camera;
    camera.fps = recorded.fps;
    camera.delay = recorded.delay;
    experiment.camera = camera;
  }
  experiment.camera.dropout = 0;  // as recorded, by camera.frames
  experiment.camera.frame_loss = 0;
  experiment.camera.film = {};
  experiment.cameras.clear();
  experiment.faults.message_loss = 0;
  // The errors of a simulated tracker are known.
  if (recorded.tracker == Tracker::kCamera) {
    experiment.camera.position_noise = facts.position_noise.value_or(0);
    experiment.camera.heading_noise = facts.heading_noise.value_or(0);
    twin.remarks.push_back(fmt::format(
        "The noise of the tracker is that measured in the run: {:.2g} cm per axis and {:.2g}°.",
        experiment.camera.position_noise / units::kCentimetre,
        experiment.camera.heading_noise / units::kDegree));
  }
  if (!experiment.light.steps.empty() && !facts.steps.empty()) {
    if (auto steps = shownSteps(facts)) {
      experiment.light.steps = std::move(*steps);
      experiment.light.repeat = false;
      experiment.light.length = 0;
    } else {
      twin.remarks.emplace_back(
          "The steps of the light are those of the script, with its conditions decided anew in "
          "each "
          "twin: which ones the run showed is not known.");
    }
  }
  if (!startAsRecorded(experiment, facts)) {
    twin.remarks.emplace_back(
        "The robots begin where the experiment file says, not at the recorded places.");
  }
  if (facts.marks > 0) {
    twin.remarks.push_back(fmt::format(
        "The run has {} marks; light by hand, pauses and stops by users are not repeated.",
        facts.marks));
  }
  if (!facts.ended) twin.remarks.emplace_back("The run has no END event: it was cut short.");
  return twin;
}

std::string framesText(const std::vector<report::RecordedFrame>& frames) {
  std::string text = "t_s,missing\n";
  text.reserve(frames.size() * 12);
  for (const report::RecordedFrame& frame : frames) {
    fmt::format_to(std::back_inserter(text), "{:.6f},", frame.t);
    for (std::size_t i = 0; i < frame.missing.size(); ++i) {
      fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "" : " ", frame.missing[i]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace lab::runner::campaign
