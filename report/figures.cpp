#include "report/figures.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include "report/figure_scripts.hpp"
#include "report/gnuplot.hpp"
#include "report/report_error.hpp"

namespace lab::report {
namespace fs = std::filesystem;

namespace style {

std::string_view programColour(int key) {
  constexpr std::array<std::string_view, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                     "#E69F00", "#56B4E9", "#000000"};
  return key < 0 ? kGrey : kColours[static_cast<std::size_t>(key) % kColours.size()];
}

std::string preamble(const std::string& name, int width, int height) {
  return fmt::format(
      "reset\n"
      "set encoding utf8\n"
      "set terminal svg size {},{} dynamic font 'Arial,16' background 'white' noenhanced "
      "linewidth 1.2\n"
      "set output '{}.svg'\n"
      "set border lc rgb '#404040'\n"
      "set tics nomirror tc rgb '#202020'\n"
      "set key noenhanced samplen 2.2\n",
      width, height, name);
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
  }
  std::string all = "cd " + gnuplotText(fs::absolute(scratch).string()) + "\n";
  bool any = false;
  for (const FigureScript& one : scripts) {
    all += one.script;
    any = any || !one.script.empty();
  }
  if (any) runGnuplot(scratch, all);

  std::vector<Figure> figures;
  for (FigureScript& one : scripts) {
    if (!one.script.empty()) {
      const fs::path file = scratch / (one.figure.name + ".svg");
      std::ifstream stream(file, std::ios::binary);
      const std::string svg{std::istreambuf_iterator<char>(stream),
                            std::istreambuf_iterator<char>()};
      if (svg.empty()) throw ReportError("gnuplot drew nothing for " + one.figure.title);
      one.figure.svg = tidySvg(svg, one.figure.title);
      fs::remove(file);
    }
    figures.push_back(std::move(one.figure));
  }
  return figures;
}

}  // namespace lab::report
