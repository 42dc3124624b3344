#include "common/experiment/checks/program_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/file_values.hpp"
#include "common/text/nearest_word.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/formula.hpp"

namespace lab::keys {
namespace {

std::string programList(const ExperimentForm& form) {
  std::string list;
  for (const auto& [name, program] : form.common.programs) {
    list += (list.empty() ? "" : ", ") + tomlString(name);
  }
  return list;
}

void checkTwins(const std::map<std::string, Program>& programs, Problems& problems) {
  for (auto twin = programs.begin(); twin != programs.end(); ++twin) {
    for (auto first = programs.begin(); first != twin; ++first) {
      if (first->second.hash != twin->second.hash) continue;
      problems.add("programs." + twin->first,
                   "found the same as programs." + first->first +
                       ", allowed programs that differ: the analyzer knows them by what they do");
      break;
    }
  }
}

/// The arena contains the place.
void checkPlace(const ExperimentForm& form, std::size_t index, Problems& problems) {
  const SenseSpec& sense = form.common.senses.values[index];
  const bool place =
      sense.kind == SenseKind::kPlaceDistance || sense.kind == SenseKind::kPlaceBearing;
  if (!place || problems.concern("arena.width_cm") || problems.concern("arena.height_cm")) return;
  const auto check = [&](const char* key, double at, double size) {
    if (at >= 0 && at <= size) return;
    problems.add("senses.values[" + std::to_string(index) + "]." + key,
                 "found " + centimetreText(at) + ", allowed 0 to " + centimetreText(size) +
                     " (inside the arena)");
  };
  check("x_cm", sense.x, form.common.arena_width);
  check("y_cm", sense.y, form.common.arena_height);
}

/// Expressions use senses that are measured.
void checkExpressions(const std::vector<SenseSpec>& senses, Problems& problems) {
  const auto suggest = [](std::string_view word, const std::vector<std::string>& words) {
    return didYouMean(word, words);
  };
  unsigned measured = 0;
  for (const SenseSpec& sense : senses) {
    if (sense.kind != SenseKind::kExpression) measured |= 1U << static_cast<unsigned>(sense.index);
  }
  for (std::size_t i = 0; i < senses.size(); ++i) {
    if (senses[i].kind != SenseKind::kExpression) continue;
    try {
      static_cast<void>(language::Formula::ofSenses(senses[i].value, measured, suggest));
    } catch (const language::SyntaxError& error) {
      problems.add("senses.values[" + std::to_string(i) + "].value",
                   "found " + tomlString(senses[i].value) + ", at character " +
                       std::to_string(error.offset() + 1) + ": " + error.what());
    }
  }
}

/// A tracker needs some time, so a delay that is shorter cannot be kept.
void checkDelay(const Experiment& e, Problems& problems) {
  if (e.senses.delay == 0 || problems.concern("camera.fps") || problems.concern("camera.delay_ms"))
    return;
  const bool simulated = e.camera.tracker == Tracker::kSimPoses;
  const double least = std::max(1 / e.camera.fps, simulated ? e.camera.delay : 0.0);
  if (e.senses.delay >= least) return;
  problems.add("senses.delay_ms",
               "found " + numberText(e.senses.delay * 1000) + ", allowed " +
                   numberText(std::ceil(least * 1000)) + " or more (" +
                   (least > 1 / e.camera.fps ? "camera.delay_ms" : "one frame of camera.fps") +
                   "), or 0: as soon as the tracker has the poses");
}

/// Every sense that a program reads is defined, and once.
void checkSenses(const Experiment& e, Problems& problems) {
  unsigned defined = 0;
  for (std::size_t i = 0; i < e.senses.values.size(); ++i) {
    const auto bit = 1U << static_cast<unsigned>(e.senses.values[i].index);
    if ((defined & bit) != 0) {
      problems.add("senses.values[" + std::to_string(i) + "].sense",
                   "found " + std::to_string(e.senses.values[i].index) +
                       ", allowed a number that no entry before it has");
    }
    defined |= bit;
  }
  for (const auto& [name, program] : e.programs) {
    for (unsigned i = 0; i < dynamics::kSenses; ++i) {
      if ((program.senses >> i & 1U) == 0 || (defined >> i & 1U) != 0) continue;
      problems.add("programs." + name,
                   "found sense(" + std::to_string(i) +
                       "), allowed only what [senses] defines: add {sense = " + std::to_string(i) +
                       ", is = \"neighbours\"} or another kind to senses.values");
    }
  }
}

}  // namespace

bool wheelsAreKnown(const Problems& problems) {
  return !problems.concern("robot.diameter_cm") &&
         !problems.concern("robot.max_wheel_speed_cm_s") &&
         !problems.concern("robot.sensor_period_ms");
}

void checkProgramName(const ExperimentForm& form, const std::string& path, const std::string& name,
                      Problems& problems) {
  if (problems.concern("programs") || form.common.programs.contains(name)) return;
  std::vector<std::string> names;
  for (const auto& [known, program] : form.common.programs) names.push_back(known);
  problems.add(path, "found " + tomlString(name) + ", allowed the name of a program: " +
                         programList(form) + didYouMean(name, names, tomlString));
}

void checkPrograms(const ExperimentForm& form, Problems& problems) {
  if (problems.concern("programs")) return;
  checkTwins(form.common.programs, problems);
  if (problems.concern("senses")) return;
  checkSenses(form.common, problems);
  for (std::size_t i = 0; i < form.common.senses.values.size(); ++i) checkPlace(form, i, problems);
  checkExpressions(form.common.senses.values, problems);
  checkDelay(form.common, problems);
}

}  // namespace lab::keys
