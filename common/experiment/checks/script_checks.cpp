#include "common/experiment/checks/script_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/experiment/checks/observable_checks.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/experiment/observable_names.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/files/file_values.hpp"
#include "common/text/nearest_word.hpp"

namespace lab::keys {
namespace {

std::string stepPath(std::size_t index) { return "light.steps[" + std::to_string(index) + "]"; }

bool checkStepForms(const ExperimentForm& form, Problems& problems) {
  const bool holds = form.light_steps.front().hold.has_value();
  const std::string allowed = holds ? "hold_s alone, as in light.steps[0]"
                                    : "at_s alone, as in light.steps[0] (or hold_s in all steps)";
  bool fine = true;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    if (step.at.has_value() != holds && step.hold.has_value() == holds) continue;
    std::string found = "neither at_s nor hold_s";
    if (step.at) found = "at_s";
    if (step.hold) found = step.at ? "both at_s and hold_s" : "hold_s";
    problems.add(stepPath(i),
                 "found " + found + ", allowed " + (i == 0 ? "either at_s or hold_s" : allowed));
    fine = false;
    if (i == 0) break;
  }
  return fine;
}

/// Checks that until and back_to are used only with hold_s.
bool checkOpenSteps(const ExperimentForm& form, Problems& problems) {
  if (form.light_steps.front().hold) return true;
  bool fine = true;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    if (!step.has_until && step.back_to.empty()) continue;
    problems.add(stepPath(i) + (step.has_until ? ".until" : ".back_to"),
                 std::string("found next to at_s, allowed where all steps have hold_s") +
                     (step.has_until ? " (which is then the limit)" : ""));
    fine = false;
  }
  return fine;
}

/// The names of the estimates that the analyzer computes (analyzer/curves/estimates.cpp). Which of
/// them a program has depends on its law (LawKnowledge::estimates).
constexpr std::array<std::string_view, 10> kEstimates{"D", "D_r",   "D_slope", "D_t", "L_s",
                                                      "V", "gamma", "tau_r",   "v",   "v_a"};

template <typename Names>
std::string listed(const Names& names) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + tomlString(name);
  return list;
}

/// The programs that the light table selects.
std::map<std::string, const Program*> selectedPrograms(const ExperimentForm& form) {
  std::map<std::string, const Program*> selected;
  for (const LightBand& band : form.common.light_table.bands) {
    const auto program = form.common.programs.find(band.program);
    if (program != form.common.programs.end()) selected[band.program] = &program->second;
  }
  return selected;
}

void checkEstimate(const ExperimentForm& form, const std::string& path, const EndCondition& until,
                   const LawKnowledge& laws, Problems& problems) {
  if (problems.concern("programs") || problems.concern("light_table")) return;
  const auto selected = selectedPrograms(form);
  const auto program = selected.find(until.program);
  if (program == selected.end()) {
    std::vector<std::string> names;
    for (const auto& [name, chosen] : selected) names.push_back(name);
    problems.add(path + ".program", "found " + tomlString(until.program) +
                                        ", allowed the name of a program that the light table "
                                        "selects: " +
                                        listed(names));
    return;
  }
  const bool stands = program->second->fastest_wheel == 0;
  std::vector<std::string> measured(kEstimates.begin(), kEstimates.end());
  if (laws.estimates) {
    measured = laws.estimates(*program->second, form.common.hardware.diameter);
  }
  if (!stands && std::ranges::find(measured, until.estimate) != measured.end()) return;
  const bool of_another = std::ranges::find(kEstimates, until.estimate) != kEstimates.end();
  problems.add(path + ".estimate",
               "found " + tomlString(until.estimate) +
                   (of_another && !stands ? ", which is not measured of this program" : "") +
                   ", allowed " +
                   (stands ? "none: nothing is measured of robots that stand"
                           : listed(measured) + didYouMean(until.estimate, measured, tomlString)));
}

void checkObservable(const ExperimentForm& form, const std::string& path, const EndCondition& until,
                     Problems& problems) {
  const bool known =
      checkObservableName(form, path + ".observable", until.observable, false, problems);
  checkCrowdSize(form, path + ".observable", problems);
  checkObservableProgram(form, path + ".program", until.program, problems);
  const bool compared = until.above || until.below;
  if (!compared && until.relative_error == 0) {
    problems.add(path, "found " + tomlString(until.observable) +
                           " without a limit, allowed with above, below or a relative error");
  } else if (compared && until.relative_error != 0) {
    problems.add(path, "found above or below beside a relative error, allowed one of them");
  } else if (known && compared && !hasValueInFrames(until.observable)) {
    problems.add(path + ".observable", "found " + tomlString(until.observable) +
                                           ", which is an average over the run, allowed with a "
                                           "relative error instead of above and below");
  }
}

void checkTumbles(const ExperimentForm& form, const std::string& path, const EndCondition& until,
                  Problems& problems) {
  if (problems.concern("programs") || problems.concern("light_table")) return;
  const auto selected = selectedPrograms(form);
  const bool tumbling = std::ranges::any_of(
      selected, [](const auto& program) { return program.second->phases.size() > 1; });
  if (tumbling) return;
  problems.add(path + ".tumbles", "found " + std::to_string(until.tumbles) +
                                      ", allowed only where the light table selects a program "
                                      "that tumbles: one with a second phase");
}

/// Whether a robot's axis can be in a part of [middle - half, middle + half].
bool reaches(double middle, double half, double size, double radius) {
  return middle + half >= radius && middle - half <= size - radius;
}

void checkRegion(const ExperimentForm& form, const std::string& path, const EndCondition& until,
                 Problems& problems) {
  if (problems.concern("arena") || problems.concern("robot")) return;
  const bool circle = until.region == Region::kCircle;
  const double width = form.common.arena_width;
  const double height = form.common.arena_height;
  const double rim = form.common.hardware.diameter / 2;
  // A circle in a corner of this rectangle may reach it with none of its extreme points, so the
  // nearest point of the rectangle decides.
  const double to_x = until.x - std::clamp(until.x, rim, std::max(rim, width - rim));
  const double to_y = until.y - std::clamp(until.y, rim, std::max(rim, height - rim));
  const bool entered = circle ? std::hypot(to_x, to_y) <= until.radius
                              : reaches(until.x, until.width / 2, width, rim) &&
                                    reaches(until.y, until.height / 2, height, rim);
  if (entered) return;
  problems.add(path + ".x_cm",
               "found a region around " + centimetreText(until.x) + ", " + centimetreText(until.y) +
                   " that no robot can enter, allowed one that reaches into " +
                   centimetreText(rim) + " to " + centimetreText(width - rim) + ", " +
                   centimetreText(rim) + " to " + centimetreText(height - rim));
}

void checkOneRobot(const ExperimentForm& form, const std::string& path, std::int32_t robot,
                   Problems& problems) {
  if (robot == 0 || problems.concern("robots")) return;
  const bool known = std::ranges::any_of(form.robots, [robot](const RobotEntry& entry) {
    return robot >= entry.id && robot < entry.id + entry.count;
  });
  if (known) return;
  problems.add(path + ".robot",
               "found " + std::to_string(robot) + ", allowed the id of a robot of this file");
}

void checkUntil(const ExperimentForm& form, const std::string& path, const EndCondition& until,
                const LawKnowledge& laws, Problems& problems) {
  std::string found;
  const auto note = [&found](bool there, const char* name) {
    if (there) found += (found.empty() ? "" : " and ") + std::string(name);
  };
  note(!until.estimate.empty(), "estimate");
  note(!until.observable.empty(), "observable");
  note(until.tumbles != 0, "tumbles");
  note(until.region != Region::kNone, "region");
  if (found.empty() || found.find(" and ") != std::string::npos) {
    problems.add(path, "found " + (found.empty() ? "nothing to wait for" : found) +
                           ", allowed one of estimate, observable, tumbles and region");
    return;
  }
  checkOneRobot(form, path, until.robot, problems);
  if (!until.estimate.empty()) checkEstimate(form, path, until, laws, problems);
  if (!until.observable.empty()) checkObservable(form, path, until, problems);
  if (until.tumbles != 0) checkTumbles(form, path, until, problems);
  if (until.region != Region::kNone) checkRegion(form, path, until, problems);
}

/// Checks that back_to names exactly one step up to this one.
bool checkLabel(const LightScript& script, std::size_t index, Problems& problems) {
  const std::string& label = script.steps[index].back_to;
  const std::string path = stepPath(index) + ".back_to";
  const auto has_label = [&label](const LightStep& step) { return step.label == label; };
  const auto count = std::ranges::count_if(script.steps, has_label);
  const auto first = std::ranges::find_if(script.steps, has_label) - script.steps.begin();
  const std::string found = "found " + tomlString(label) + ", ";
  if (count == 0) {
    std::vector<std::string> labels;
    for (std::size_t i = 0; i <= index && i < 8; ++i) labels.push_back(script.steps[i].label);
    problems.add(path, found + "allowed the label of a step up to this one: " + listed(labels) +
                           (index >= 8 ? ", ..." : ""));
  } else if (count > 1) {
    problems.add(path, found + "the label of " + std::to_string(count) +
                           " steps, allowed a label that only one step has");
  } else if (first > static_cast<std::ptrdiff_t>(index)) {
    problems.add(path, found + "the label of " + stepPath(static_cast<std::size_t>(first)) +
                           ", which comes later, allowed a step up to this one");
  } else {
    return true;
  }
  return false;
}

bool checkGroups(const LightScript& script, Problems& problems) {
  bool fine = true;
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    if (!script.steps[i].back_to.empty()) fine = checkLabel(script, i, problems) && fine;
  }
  if (!fine) return false;
  const std::vector<StepGroup> groups = groupsOf(script);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      // Groups are sorted by their last steps: the later one must begin after the earlier one or
      // contain it.
      if (groups[i].first > groups[j].last || groups[i].first <= groups[j].first) continue;
      problems.add(stepPath(groups[i].last) + ".back_to",
                   "found " + tomlString(script.steps[groups[i].last].back_to) +
                       ", inside the steps that " + stepPath(groups[j].last) +
                       " repeats, which end before this one; allowed groups within each other or "
                       "one after the other");
      fine = false;
      break;
    }
  }
  return fine;
}

void checkLength(const ExperimentForm& form, Problems& problems) {
  const bool holds = form.light_steps.front().hold.has_value();
  const bool repeat = form.common.light.repeat;
  if (form.light_length && (!repeat || holds)) {
    problems.add("light.length_s", "found " + numberText(*form.light_length) + ", allowed only " +
                                       (holds ? "where steps have at_s" : "with repeat = true"));
  } else if (repeat && !holds && !form.light_length) {
    problems.add("light.repeat",
                 "found true, allowed with length_s (when does the last step "
                 "end?), or with hold_s in all steps");
  }
}

/// When a step that begins then may end at the earliest [s], as one computes it by hand.
std::string earliestEnd(double begin) {
  return numberText(roundedToDigits(begin + kShortestStep, 12));
}

void checkStepTimes(const ExperimentForm& form, const LightScript& script, Problems& problems) {
  const std::vector<double> times = stepTimes(form);
  const bool holds = form.light_steps.front().hold.has_value();
  const double duration = form.common.duration;
  const std::string when = script.isPlanned() ? "" : " at the latest";
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    const double length = step.hold.value_or(times[i + 1] - times[i]);
    const std::string key = stepPath(i) + (holds ? ".hold_s" : ".at_s");
    const std::string found = "found " + numberText(times[i]) + ", allowed ";
    if (i == 0 && times[i] != 0) {
      problems.add(key, found + "0: the first step begins with the run");
    } else if (i > 0 && !(times[i] > times[i - 1])) {
      problems.add(key, found + "above " + numberText(times[i - 1]) +
                            ", the at_s of the step "
                            "before");
    } else if (!form.recorded && holds && !isLongEnough(0, *step.hold)) {
      problems.add(key, "found " + numberText(*step.hold) + ", allowed at least " +
                            numberText(kShortestStep) + ": a step lasts as long or longer");
    } else if (!form.recorded && i > 0 && !holds && !isLongEnough(times[i - 1], times[i])) {
      problems.add(key, found + "at least " + earliestEnd(times[i - 1]) + ": a step lasts " +
                            numberText(kShortestStep) + " s or longer");
    } else if (!script.repeat && !problems.concern("duration_s") && times[i] >= duration) {
      problems.add(key, "found a step that begins at " + numberText(times[i]) + " s" + when +
                            ", allowed below duration_s = " + numberText(duration) +
                            " (or repeat = true)");
    } else if (length > 0 && step.ramp > length) {
      problems.add(stepPath(i) + ".ramp_s", "found " + numberText(step.ramp) + ", allowed 0 to " +
                                                fileText(length, unitOf("")) +
                                                ", as long as the step");
    }
  }
  if (!form.light_length) return;
  const double last = times[times.size() - 2];
  const std::string found = "found " + numberText(*form.light_length) + ", allowed ";
  if (*form.light_length <= last) {
    problems.add("light.length_s",
                 found + "above " + numberText(last) + ", the at_s of the last step");
  } else if (!form.recorded && !isLongEnough(last, *form.light_length)) {
    problems.add("light.length_s", found + "at least " + earliestEnd(last) +
                                       ": the last step lasts " + numberText(kShortestStep) +
                                       " s or longer");
  }
}

/// Checks that the log can hold the steps. Those with a condition count with their limits: one that
/// is met earlier needs a message for each step, which is in the log anyway.
void checkNumberOfSteps(const ExperimentForm& form, const LightScript& script, Problems& problems) {
  if (form.recorded || problems.concern("duration_s") || problems.concern("light")) return;
  const std::vector<double> times = stepTimes(form);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    lengths.push_back(form.light_steps[i].hold.value_or(times[i + 1] - times[i]));
  }
  const double duration = form.common.duration;
  const ShownSteps shown = countSteps(script, lengths, duration, kMostShownSteps + 1);
  if (shown.steps <= kMostShownSteps) return;
  problems.add("light.steps", "found more than " + std::to_string(kMostShownSteps) +
                                  " steps in the first " + numberText(std::round(shown.time)) +
                                  " s of duration_s = " + numberText(duration) +
                                  ", allowed at most " + std::to_string(kMostShownSteps) +
                                  " in a run: lengthen the steps or shorten duration_s");
}

/// Checks that no limit of a condition is after the run's end, where if_not would have no effect.
void checkLimits(const ExperimentForm& form, const LightScript& script, Problems& problems) {
  if (script.repeat || problems.concern("duration_s") || problems.concern("light.steps")) return;
  const auto begins = stepTimes(form);
  for (std::size_t i = script.steps.size(); i-- > 0;) {
    if (!script.steps[i].until.given()) continue;
    std::size_t last = i;
    for (const StepGroup& group : groupsOf(script)) {
      if (group.first <= i && group.last >= i) last = std::max(last, group.last);
    }
    if (begins[last + 1] <= form.common.duration) return;
    problems.add(
        stepPath(i) + ".hold_s",
        "found a limit that may come " + numberText(begins[last + 1]) +
            " s after the start, allowed up to duration_s = " + numberText(form.common.duration) +
            ": shorten the limits, or raise duration_s (a run that ends early costs no "
            "more for it)");
    return;
  }
}

std::string rulePath(std::size_t index) { return "stop_when[" + std::to_string(index) + "]"; }

}  // namespace

void checkStopRules(const ExperimentForm& form, const LawKnowledge& laws, Problems& problems) {
  const std::vector<StopRule>& rules = form.common.stop_when;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const std::string path = rulePath(i);
    if (problems.concern(path)) continue;
    const EndCondition& until = rules[i].until;
    if (until.observable.empty()) {
      checkEstimate(form, path, until, laws, problems);
    } else {
      checkObservable(form, path, until, problems);
    }
    checkOneRobot(form, path, until.robot, problems);
    if (!problems.concern("duration_s") && rules[i].at_least >= form.common.duration) {
      problems.add(path + ".at_least_s",
                   "found " + numberText(rules[i].at_least) +
                       ", allowed below duration_s = " + numberText(form.common.duration));
    }
    for (std::size_t k = 0; k < i; ++k) {
      const EndCondition& other = rules[k].until;
      const bool same = other.estimate == until.estimate && other.observable == until.observable &&
                        other.program == until.program && other.robot == until.robot;
      if (!same) continue;
      const bool observable = !until.observable.empty();
      problems.add(path + (observable ? ".observable" : ".estimate"),
                   "found " + tomlString(observable ? until.observable : until.estimate) + " of " +
                       tomlString(until.program) + ", which " + rulePath(k) +
                       " asks for already, allowed one rule for each number");
      break;
    }
  }
}

void checkScript(const ExperimentForm& form, const LawKnowledge& laws, Problems& problems) {
  const bool forms = checkStepForms(form, problems) && checkOpenSteps(form, problems);
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    if (!form.light_steps[i].has_until) continue;
    checkUntil(form, stepPath(i) + ".until", form.light_steps[i].until, laws, problems);
  }
  const LightScript script = scriptOf(form);
  if (!forms || !checkGroups(script, problems)) return;
  checkLength(form, problems);
  checkStepTimes(form, script, problems);
  checkLimits(form, script, problems);
  checkNumberOfSteps(form, script, problems);
}

}  // namespace lab::keys
