#include "common/experiment/checks/program_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "common/files/file_values.hpp"
#include "common/text/nearest_word.hpp"

namespace lab::keys {
namespace {

constexpr double kRelativeSlack = 1e-9;  // [1]

std::string programList(const ExperimentForm& form) {
  std::string list;
  for (const auto& [name, program] : form.common.programs) {
    list += (list.empty() ? "" : ", ") + tomlString(name);
  }
  return list;
}

std::string wayOut(ProgramKind model) {
  switch (model) {
    case ProgramKind::kAbp:
      return "lower v_cm_s or eta_rad_s";
    case ProgramKind::kNoisyAbp:
      return "lower V_cm_s or va_cm_s";
    case ProgramKind::kBp:
      return "lower V_cm_s";
    case ProgramKind::kRtp:
      return "lower v_cm_s or raise tau_t_s";
    default:
      return "lower the wheel speeds";
  }
}

void checkTime(const std::string& path, double time, double sensor_period, Problems& problems) {
  const double milliseconds = time * 1000;
  if (std::abs(milliseconds - std::round(milliseconds)) > 1e-6) {
    problems.add(path, "found " + numberText(time) + ", allowed whole milliseconds, as " +
                           numberText(std::max(1.0, std::round(milliseconds)) / 1000));
  } else if (time < sensor_period * (1 - kRelativeSlack)) {
    problems.add(path, "found " + numberText(time) + ", allowed at least " +
                           numberText(sensor_period) + " (robot.sensor_period_ms)");
  }
}

void checkProgram(const std::string& name, const RobotProgram& program,
                  const RobotHardware& hardware, Problems& problems) {
  const std::string path = "programs." + name;
  if (problems.concern(path) || !wheelsAreKnown(problems)) return;
  const ProgramKind model = program.kind;
  if (model == ProgramKind::kAbp || model == ProgramKind::kNoisyAbp || model == ProgramKind::kBp) {
    checkTime(path + ".epsilon_s", program.epsilon, hardware.sensor_period, problems);
  }
  if (model == ProgramKind::kRtp) {
    checkTime(path + ".tau_t_s", program.tau_t, hardware.sensor_period, problems);
  }
  if (problems.concern(path)) return;
  const auto result = dynamics::toProgramParams(program, wheelLimits(hardware));
  if (!result.ok) {
    problems.add(path, "found " + result.reason + "; allowed: " + wayOut(model) +
                           ", or raise robot.max_wheel_speed_cm_s");
  }
}

void checkTwins(const std::map<std::string, RobotProgram>& programs, Problems& problems) {
  for (auto twin = programs.begin(); twin != programs.end(); ++twin) {
    for (auto first = programs.begin(); first != twin; ++first) {
      if (!(first->second == twin->second)) continue;
      problems.add("programs." + twin->first,
                   "found the same as programs." + first->first +
                       ", allowed programs that differ: the analyzer knows them by what they do");
      break;
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
  for (const auto& [name, program] : form.common.programs) {
    checkProgram(name, program, form.common.hardware, problems);
  }
  if (!problems.concern("programs")) checkTwins(form.common.programs, problems);
}

}  // namespace lab::keys
