#include "analyzer/report/figures/figures.hpp"

#include <array>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/sections/run_section.hpp"

namespace lab::report {
namespace fs = std::filesystem;

namespace style {

std::string_view programColour(int key) {
  constexpr std::array<std::string_view, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                     "#E69F00", "#56B4E9", "#000000"};
  return key < 0 ? kGrey : kColours[static_cast<std::size_t>(key) % kColours.size()];
}

std::string preamble(const std::string& name, int width, int height, double print_cm) {
  return fmt::format(
      "reset\n"
      "set encoding utf8\n"
      "eval open_figure('{}', {}, {}, {:.4g})\n"
      "set border lc rgb '#404040'\n"
      "set tics nomirror tc rgb '#202020'\n"
      "set key noenhanced samplen 2.2\n",
      name, width, height, print_cm);
}

TimeAxis timeAxis(double duration) {
  if (duration <= 300) return {1, "s"};
  if (duration <= 4 * 3600) return {60, "min"};
  return {3600, "h"};
}

}  // namespace style

std::vector<Figure> drawFigures(const RunRecord& record, const fs::path& scratch) {
  std::vector<FigureScript> scripts{trajectoryByTime(record), trajectoryByProgram(record)};
  if (!record.poses) scripts.push_back(lightAndPrograms(record));
  scripts.push_back(speedTraces(record));
  for (const Finding& finding : findingsOf(record)) {
    scripts.push_back(msdFigure(finding));
    scripts.push_back(angularMsdFigure(finding));
    const auto& runs = finding.pool->result.runs;
    if (runs && runs->problem.empty()) {
      scripts.push_back(runTimesFigure(finding));
      scripts.push_back(turnsFigure(finding));
    }
  }
  return drawScripts(std::move(scripts), scratch);
}

}  // namespace lab::report
