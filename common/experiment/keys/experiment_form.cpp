#include "common/experiment/keys/experiment_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/experiment/script_plan.hpp"
#include "common/files/file_values.hpp"
#include "light/field/layer.hpp"

namespace lab::keys {
namespace {

using light::LayerKind;

double phaseRate(double speed, double period) { return 2 * std::numbers::pi * speed / period; }

/// The speed that a file can express with the fewest digits and that gives exactly this rate, so
/// that a written file reads back as the same experiment.
double speedOf(double rate, double period) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const FileUnit& unit = unitOf("_cm_s");
  const double near = rate * period / (2 * std::numbers::pi);
  const double in_file = near * unit.divide / unit.multiply;
  for (const double start :
       {in_file, std::nextafter(in_file, -kInfinity), std::nextafter(in_file, kInfinity)}) {
    for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
      const double speed = toSi(roundedToDigits(start, digits), unit);
      if (phaseRate(speed, period) == rate) return speed;
    }
  }
  return near;
}

std::string labelOf(const ExperimentForm& form, std::size_t index) {
  const std::string& label = form.light_steps[index].label;
  return label.empty() ? "step " + std::to_string(index + 1) : label;
}

/// Corrects rounding errors: a robot that touches a wall must not be outside.
double clampInside(double place, double size, double radius) {
  return std::max(radius, std::min(place, size - radius));
}

std::vector<RobotSpec> toRobots(const std::vector<RobotEntry>& entries, const Experiment& common) {
  const double radius = common.hardware.diameter / 2;
  std::vector<RobotSpec> robots;
  for (const RobotEntry& entry : entries) {
    for (std::int64_t i = 0; i < entry.count; ++i) {
      RobotSpec robot;
      robot.id = static_cast<std::int32_t>(entry.id + i);
      robot.body = entry.body;
      robot.uid = static_cast<std::uint32_t>(entry.uid);
      robot.log = entry.log;
      robot.from = entry.from;
      if (entry.body == Body::kReplay) {
        const std::int64_t first = entry.recorded_id == 0 ? entry.id : entry.recorded_id;
        robot.recorded_id = static_cast<std::int32_t>(first + i);
      }
      if (entry.x) {
        robot.start = StartPose{clampInside(*entry.x, common.arena_width, radius),
                                clampInside(*entry.y, common.arena_height, radius), *entry.theta};
      }
      robots.push_back(robot);
    }
  }
  std::ranges::sort(robots, {}, &RobotSpec::id);
  return robots;
}

bool sharesEntry(const RobotEntry& entry, const RobotSpec& robot) {
  const bool plain = !robot.start && !entry.x && robot.uid == 0 && entry.uid == 0 &&
                     robot.log.empty() && entry.log.empty();
  return plain && entry.body == robot.body && entry.id + entry.count == robot.id;
}

/// Robots with consecutive ids and otherwise equal share an entry.
std::vector<RobotEntry> toEntries(const std::vector<RobotSpec>& robots) {
  std::vector<RobotEntry> entries;
  for (const RobotSpec& robot : robots) {
    if (!entries.empty() && sharesEntry(entries.back(), robot)) {
      ++entries.back().count;
      continue;
    }
    RobotEntry entry;
    entry.id = robot.id;
    entry.body = robot.body;
    entry.uid = robot.uid;
    entry.log = robot.log;
    entry.recorded_id = robot.recorded_id;
    entry.from = robot.from;
    if (robot.start) {
      entry.x = robot.start->x;
      entry.y = robot.start->y;
      entry.theta = robot.start->theta;
    }
    entries.push_back(entry);
  }
  return entries;
}

}  // namespace

void expandShorthand(ExperimentForm& form) {
  if (form.program.empty()) return;
  if (form.common.light_table.bands.empty()) {
    form.common.light_table.bands = {{0, 1, form.program}};
  }
  if (form.light_steps.empty()) {
    StepEntry step;
    step.at = 0;
    step.layers.emplace_back();
    step.layers.back().layer.intensity = kShorthandLight;
    form.light_steps.push_back(step);
  }
}

std::vector<double> stepTimes(const ExperimentForm& form) {
  std::vector<double> times;
  if (!form.light_steps.empty() && form.light_steps.front().hold) {
    for (const StepEntry& step : form.light_steps) times.push_back(step.hold.value_or(0));
    return latestStartTimes(times, groupsOf(scriptOf(form)));
  }
  for (const StepEntry& step : form.light_steps) times.push_back(step.at.value_or(0));
  times.push_back(form.light_length.value_or(std::numeric_limits<double>::infinity()));
  return times;
}

LightScript scriptOf(const ExperimentForm& form) {
  LightScript script = form.common.light;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& entry = form.light_steps[i];
    LightStep step;
    step.ramp = entry.ramp;
    step.label = labelOf(form, i);
    step.until = entry.until;
    step.if_not = entry.if_not;
    step.back_to = entry.back_to;
    step.times = entry.times;
    for (const LayerEntry& layer : entry.layers) {
      step.layers.push_back(toLayer(layer, form.common));
    }
    script.steps.push_back(std::move(step));
  }
  return script;
}

std::optional<double> lightFor(const LightTable& table, const std::string& program) {
  const auto band = std::ranges::find(table.bands, program, &LightBand::program);
  if (band == table.bands.end()) return {};
  return 0.5 * (band->low + band->high);
}

LayerSpec toLayer(const LayerEntry& entry, const Experiment& common) {
  LayerSpec layer = entry.layer;
  const auto kind = static_cast<LayerKind>(layer.kind);
  if (kind != LayerKind::kUniform) {
    const bool in_robots_frame = layer.drive.follow == light::Follow::kRobots;
    layer.x = entry.x.value_or(in_robots_frame ? 0 : common.arena_width / 2);
    layer.y = entry.y.value_or(in_robots_frame ? 0 : common.arena_height / 2);
  }
  if (kind == LayerKind::kWave) layer.drive.phase_rate = phaseRate(entry.speed, layer.size);
  if (kind == LayerKind::kNoise) layer.drive.phase_rate = entry.change;
  if (!layer.drive.images.empty()) layer.image = layer.drive.images.front();
  if (!entry.program.empty()) {
    layer.intensity = lightFor(common.light_table, entry.program).value_or(0);
  }
  return layer;
}

LayerEntry toEntry(const LayerSpec& layer) {
  LayerEntry entry{.layer = layer, .x = layer.x, .y = layer.y};
  entry.has_crowd = layer.crowd.given();
  const auto kind = static_cast<LayerKind>(layer.kind);
  if (kind == LayerKind::kWave) entry.speed = speedOf(layer.drive.phase_rate, layer.size);
  if (kind == LayerKind::kNoise) entry.change = layer.drive.phase_rate;
  return entry;
}

Experiment toExperiment(const ExperimentForm& form) {
  Experiment experiment = form.common;
  experiment.robots = toRobots(form.robots, form.common);
  if (!experiment.cameras.empty()) experiment.camera.source = camerasOf(experiment)[0].source;
  LightScript& script = experiment.light;
  script = scriptOf(form);
  const bool planned = script.isPlanned();
  const std::vector<double> times = stepTimes(form);
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    script.steps[i].at = times[i];
    if (!planned) script.steps[i].hold = form.light_steps[i].hold.value_or(0);
  }
  script.length = script.repeat ? times.back() : 0;
  return experiment;
}

ExperimentForm toForm(const Experiment& experiment) {
  ExperimentForm form;
  form.common = experiment;
  form.common.robots.clear();
  form.common.light.steps.clear();
  form.common.light.length = 0;
  form.robots = toEntries(experiment.robots);
  const bool planned = experiment.light.isPlanned();
  for (const LightStep& step : experiment.light.steps) {
    StepEntry entry;
    entry.label = step.label;
    (planned ? entry.at : entry.hold) = planned ? step.at : step.hold;
    entry.has_until = step.until.given();
    entry.until = step.until;
    entry.if_not = step.if_not;
    entry.back_to = step.back_to;
    entry.times = step.times;
    entry.ramp = step.ramp;
    for (const LayerSpec& layer : step.layers) entry.layers.push_back(toEntry(layer));
    form.light_steps.push_back(entry);
  }
  if (planned && experiment.light.repeat) form.light_length = experiment.light.length;
  return form;
}

}  // namespace lab::keys
