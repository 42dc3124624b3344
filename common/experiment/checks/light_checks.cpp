#include "common/experiment/checks/light_checks.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/experiment/checks/layer_checks.hpp"
#include "common/experiment/checks/program_checks.hpp"
#include "common/experiment/checks/script_checks.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"

namespace lab::keys {
namespace {

/// About ten steps of the robot's converter.
constexpr double kNarrowestBand = 0.01;  // [1]

std::string bandPath(std::size_t index) {
  return "light_table.bands[" + std::to_string(index) + "]";
}

std::string bandText(const LightBand& band) {
  return '[' + numberText(band.low) + ", " + numberText(band.high) + "]";
}

/// The largest hysteresis with which every band keeps an interval of light that selects its program
/// whatever program ran before.
double widestHysteresis(std::vector<LightBand> bands) {
  std::ranges::sort(bands, {}, &LightBand::low);
  double widest = 1;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const bool lower = i > 0;
    const bool upper = i + 1 < bands.size();
    if (lower) widest = std::min(widest, bands[i].high - bands[i - 1].high);
    if (upper) widest = std::min(widest, bands[i + 1].low - bands[i].low);
    if (lower && upper) widest = std::min(widest, (bands[i + 1].low - bands[i - 1].high) / 2);
  }
  return widest;
}

void checkBands(const std::vector<LightBand>& bands, Problems& problems) {
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const LightBand& band = bands[i];
    if (!(band.high - band.low >= kNarrowestBand * (1 - 1e-9))) {
      problems.add(bandPath(i) + ".light", "found " + bandText(band) +
                                               ", allowed [low, high] with high at least " +
                                               numberText(kNarrowestBand) + " above low");
      continue;
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (band.low < bands[j].high && bands[j].low < band.high) {
        problems.add(bandPath(i) + ".light", "found " + bandText(band) + ", which overlaps " +
                                                 bandText(bands[j]) + " of " + bandPath(j) +
                                                 ", allowed bands that at most touch");
        break;
      }
    }
  }
}

void checkTable(const ExperimentForm& form, Problems& problems) {
  const LightTable& table = form.common.light_table;
  if (problems.concern("light_table.bands")) return;
  if (table.bands.empty()) {
    problems.add("light_table.bands",
                 "found none, allowed 1 to 4, as bands = [{light = [0, 1], "
                 "program = \"NAME\"}], or program = \"NAME\" at the top of "
                 "the file");
    return;
  }
  for (std::size_t i = 0; i < table.bands.size(); ++i) {
    checkProgramName(form, bandPath(i) + ".program", table.bands[i].program, problems);
  }
  checkBands(table.bands, problems);
  if (problems.concern("light_table")) return;
  const double widest = widestHysteresis(table.bands);
  if (table.bands.size() > 1 && table.hysteresis >= widest) {
    problems.add("light_table.hysteresis",
                 "found " + numberText(table.hysteresis) + ", allowed below " +
                     numberText(std::round(widest * 1e9) / 1e9) +
                     " (a band is kept this far beyond its edges: more would reach across the "
                     "whole of a neighbour, which the light could then not select)");
  }
}

void checkSteps(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                const LawKnowledge& laws, Problems& problems) {
  if (problems.concern("light.steps")) return;
  if (form.light_steps.empty()) {
    problems.add("light.steps", "found none, allowed at least one [[light.steps]]");
    return;
  }
  checkLayers(form, directory, problems);
  checkScript(form, laws, problems);
}

}  // namespace

void checkShorthand(const ExperimentForm& form, Problems& problems) {
  if (form.program.empty()) return;
  checkProgramName(form, "program", form.program, problems);
  if (!form.common.light_table.bands.empty()) {
    problems.add("program", "found " + tomlString(form.program) +
                                " next to light_table.bands, allowed one of the two");
  }
}

void checkLight(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                const LawKnowledge& laws, Problems& problems) {
  if (!problems.concern("program")) checkTable(form, problems);
  checkSteps(form, directory, laws, problems);
}

}  // namespace lab::keys
