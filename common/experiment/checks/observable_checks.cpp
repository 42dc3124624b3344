#include "common/experiment/checks/observable_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/experiment/keys/experiment_keys.hpp"
#include "common/experiment/observable_names.hpp"
#include "common/files/file_values.hpp"

namespace lab::keys {
namespace {

void append(std::string& list, const std::string& name) {
  list += (list.empty() ? "" : ", ") + tomlString(name);
}

}  // namespace

bool checkObservableName(const ExperimentForm& form, const std::string& path,
                         const std::string& name, bool of_frames, Problems& problems) {
  std::string allowed;
  for (const auto known : kFrameObservables) {
    if (name == known) return true;
    append(allowed, std::string(known));
  }
  if (!of_frames) {
    for (const auto known : kAverageObservables) {
      if (name == known) return true;
      append(allowed, std::string(known));
    }
  }
  if (problems.concern("analysis.regions")) return false;
  for (const RegionSpec& region : form.common.analysis.regions) {
    const std::string share = std::string(kShareIn) + region.name;
    if (name == share) return true;
    append(allowed, share);
  }
  problems.add(path, "found " + tomlString(name) + ", allowed " + allowed);
  return false;
}

void checkCrowdSize(const ExperimentForm& form, const std::string& path, Problems& problems) {
  if (form.recorded || problems.concern("robots")) return;
  std::int64_t robots = 0;
  for (const RobotEntry& entry : form.robots) robots += entry.count;
  constexpr auto kMost = static_cast<std::int64_t>(kMostCrowdRobots);
  if (robots <= kMost) return;
  problems.add(path, "found with " + std::to_string(robots) + " robots, allowed with up to " +
                         std::to_string(kMost) + ": collective numbers are those of the first " +
                         std::to_string(kMost) + " of a frame");
}

void checkObservableProgram(const ExperimentForm& form, const std::string& path,
                            const std::string& program, Problems& problems) {
  if (program.empty() || problems.concern("programs")) return;
  if (form.common.programs.contains(program)) return;
  std::string allowed;
  for (const auto& [name, known] : form.common.programs) append(allowed, name);
  problems.add(path,
               "found " + tomlString(program) + ", allowed the name of a program: " + allowed);
}

void checkCrowdRule(const ExperimentForm& form, const std::string& path, const LayerSpec& layer,
                    Problems& problems) {
  const CrowdRule& crowd = layer.crowd;
  const int rules =
      (crowd.gate.empty() ? 0 : 1) + (crowd.hold.empty() ? 0 : 1) + (crowd.quorum ? 1 : 0);
  if (rules != 1) {
    problems.add(path,
                 "found " + std::to_string(rules) + " rules, allowed one of gate, hold and quorum");
    return;
  }
  checkCrowdSize(form, path, problems);
  if (!crowd.gate.empty()) checkObservableName(form, path + ".gate", crowd.gate, true, problems);
  if (!crowd.hold.empty()) checkObservableName(form, path + ".hold", crowd.hold, true, problems);
  checkObservableProgram(form, path + ".program", crowd.program, problems);
  if (crowd.hold.empty() && !crowd.above && !crowd.below) {
    problems.add(path, "found no limit, allowed with above, below or both");
  }
  if (crowd.lowest > crowd.highest) {
    problems.add(path + ".lowest", "found " + numberText(crowd.lowest) +
                                       ", allowed up to highest = " + numberText(crowd.highest));
  }
  if (crowd.quorum && layer.drive.follow != light::Follow::kRobots) {
    problems.add(path + ".quorum", "found true, allowed with follow = \"robots\"");
  }
}

void checkRegions(const ExperimentForm& form, Problems& problems) {
  const std::vector<RegionSpec>& regions = form.common.analysis.regions;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (regions[k].name != regions[i].name) continue;
      problems.add("analysis.regions[" + std::to_string(i) + "].name",
                   "found " + tomlString(regions[i].name) + ", the name of regions[" +
                       std::to_string(k) + "], allowed another name for each region");
      break;
    }
  }
}

void checkTwins(const ExperimentForm& form, Problems& problems) {
  constexpr int kFewest = 10;  // of fewer, the scatter is hardly known
  const int twins = form.common.analysis.twins;
  if (problems.concern("analysis.twins") || twins == 0 || twins >= kFewest) return;
  problems.add("analysis.twins", "found " + std::to_string(twins) + ", allowed 0 or 10 to 1000");
}

}  // namespace lab::keys
