#include "common/experiment/script_plan.hpp"

#include <algorithm>
#include <cmath>

#include "common/files/file_values.hpp"

namespace lab {
namespace {

using keys::centimetreText;
using keys::fileText;
using keys::unitOf;

constexpr double kTicks = 1e6;  // [1/s] sums of hold times are rounded to 1 / kTicks

}  // namespace

bool isLongEnough(double begin, double end) {
  return std::round((end - begin) * kTicks) >= std::round(kShortestStep * kTicks);
}

std::vector<StepGroup> groupsOf(const LightScript& script) {
  std::vector<StepGroup> groups;
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    const LightStep& step = script.steps[i];
    if (step.back_to.empty()) continue;
    const auto first = std::ranges::find(script.steps, step.back_to, &LightStep::label);
    groups.push_back({static_cast<std::size_t>(first - script.steps.begin()), i, step.times});
  }
  return groups;
}

std::vector<double> latestStartTimes(const std::vector<double>& holds,
                                     const std::vector<StepGroup>& groups) {
  std::vector<double> begins{0};
  for (std::size_t i = 0; i < holds.size(); ++i) {
    // When a step begins for the first time, all repetitions of an earlier group have been shown,
    // and a group that contains the step is shown for the first time.
    double end = std::round((begins.back() + holds[i]) * kTicks) / kTicks;
    for (const StepGroup& group : groups) {
      if (group.last != i) continue;
      const double once = end - begins[group.first];
      end += static_cast<double>(group.times - 1) * once;
      end = std::round(end * kTicks) / kTicks;
    }
    begins.push_back(end);
  }
  return begins;
}

bool mayEndEarly(const LightScript& script) {
  const auto ends = [](const LightStep& step) { return step.if_not != IfNot::kNext; };
  return !script.isPlanned() && (!script.repeat || std::ranges::any_of(script.steps, ends));
}

bool mayEndEarly(const Experiment& experiment) {
  return !experiment.stop_when.empty() || mayEndEarly(experiment.light);
}

std::string conditionText(const EndCondition& until) {
  const std::string robot = until.robot == 0 ? "" : "robot " + std::to_string(until.robot);
  if (!until.estimate.empty()) {
    return until.estimate + " of " + (robot.empty() ? "" : robot + " running ") + until.program +
           " is known to " + fileText(until.relative_error, unitOf("_percent")) + " %";
  }
  if (!until.observable.empty()) {
    const std::string whose = until.program.empty() ? "" : " of " + until.program;
    std::string text;
    const auto add = [&text](const std::string& part) {
      text += (text.empty() ? "" : " and ") + part;
    };
    if (until.above) add("above " + keys::numberText(*until.above));
    if (until.below) add("below " + keys::numberText(*until.below));
    if (until.relative_error > 0) {
      add("known to " + fileText(until.relative_error, unitOf("_percent")) + " %");
    }
    return until.observable + whose + " is " + text;
  }
  if (until.tumbles != 0) {
    const std::string count =
        until.tumbles == 1 ? "a tumble" : std::to_string(until.tumbles) + " tumbles";
    return count + (robot.empty() ? "" : " of " + robot);
  }
  std::string who = until.who == Who::kAll ? "all robots are" : "a robot is";
  if (!robot.empty()) who = robot + " is";
  const std::string shape =
      until.region == Region::kCircle
          ? "circle of radius " + centimetreText(until.radius)
          : "rectangle of " + centimetreText(until.width) + " x " + centimetreText(until.height);
  return who + " in the " + shape + " cm around " + centimetreText(until.x) + ", " +
         centimetreText(until.y) + " cm";
}

ScriptCursor::ScriptCursor(const LightScript& script)
    : steps_(script.steps.size()),
      repeat_(script.repeat),
      groups_(groupsOf(script)),
      repetitions_(groups_.size(), 0) {}

const StepGroup* ScriptCursor::groupEndingHere() const {
  // Groups are sorted by their last steps.
  const auto group = std::ranges::lower_bound(groups_, index_, {}, &StepGroup::last);
  return group == groups_.end() || group->last != index_ ? nullptr : &*group;
}

bool ScriptCursor::isLast() const {
  if (repeat_ || index_ + 1 < steps_) return false;
  const StepGroup* group = groupEndingHere();
  return group == nullptr ||
         repetitions_[static_cast<std::size_t>(group - groups_.data())] + 1 >= group->times;
}

void ScriptCursor::advance() {
  if (const StepGroup* group = groupEndingHere()) {
    std::int64_t& shown = repetitions_[static_cast<std::size_t>(group - groups_.data())];
    if (++shown < group->times) {
      index_ = group->first;
      return;
    }
    shown = 0;  // for the next repetition of an enclosing group
  }
  if (++index_ < steps_) return;
  index_ = 0;
  ++pass_;
}

ShownSteps countSteps(const LightScript& script, const std::vector<double>& lengths,
                      double duration, std::int64_t most) {
  ShownSteps shown;
  ScriptCursor cursor(script);
  while (shown.steps < most && shown.time < duration) {
    ++shown.steps;
    shown.time += lengths[cursor.index()];
    if (cursor.isLast()) break;
    cursor.advance();
  }
  return shown;
}

}  // namespace lab
