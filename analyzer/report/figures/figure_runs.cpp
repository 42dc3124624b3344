#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using analysis::DensityBar;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::size_t kFewestBars = 3;

/// The common part of the figures; with a sentence if there is nothing to draw.
FigureScript start(const Finding& finding, const char* file, const char* title,
                   const std::vector<DensityBar>& bars) {
  FigureScript script;
  script.figure.name = fmt::format("{}_{}", file, finding.file);
  script.figure.title = fmt::format("{} of {}", title, finding.name);
  if (bars.size() < kFewestBars) {
    script.figure.sentence =
        fmt::format("{}: too few tumbles under {} for a histogram.", title, finding.name);
  }
  return script;
}

std::string csvOf(const std::vector<DensityBar>& bars, const char* unit, double scale) {
  CsvText csv(
      fmt::format("from_{0},to_{0},density_per_{0},standard_error_per_{0},count,"
                  "theory_per_{0}",
                  unit));
  for (const DensityBar& bar : bars) {
    csv.row(bar.low * scale, bar.high * scale, bar.density / scale, bar.sigma / scale, bar.count,
            bar.theory / scale);
  }
  return csv.text();
}

}  // namespace

FigureScript runTimesFigure(const Finding& finding) {
  const analysis::RunStatistics& runs = *finding.pool->result.runs;
  const std::vector<DensityBar>& bars = runs.run_times;
  FigureScript script = start(finding, "run_times", "Run times", bars);
  if (!script.figure.sentence.empty()) return script;
  const double programmed = finding.pool->result.law->runs()->rate;
  const double measured = runs.find("gamma")->value;
  // A point is drawn where the exponential law equals its mean over the bar.
  const auto middle = [&](const DensityBar& bar) {
    const double width = bar.high - bar.low;
    return bar.low - std::log(-std::expm1(-measured * width) / (measured * width)) / measured;
  };
  DataBlock data("runs");
  for (const DensityBar& bar : bars) {
    const double low = std::max(bar.density - bar.sigma, 0.02 * bar.density);
    data.row(middle(bar), bar.density, low, bar.density + bar.sigma - low);
  }
  script.script =
      data.text() + style::preamble(script.figure.name, 760, 480) +
      fmt::format(
          "set logscale y\nset format y '%g'\n"
          "set xlabel 'run time (s)'\nset ylabel 'probability density (1/s)' offset 0.5\n"
          "set xrange [0:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\nset key top right Right\n"
          "set samples 200\n"
          "plot {:.8g}*exp(-{:.8g}*x) with lines lw 2 dt (8,5) lc rgb '{}' title 'programmed', "
          "{:.8g}*exp(-{:.8g}*x) with lines lw 1.6 lc rgb '{}' title 'maximum likelihood', "
          "$runs using 1:3:(0):4 with vectors nohead lw 1.2 lc rgb 'black' notitle, "
          "$runs using 1:2 with points pt 7 ps 0.5 lc rgb 'black' title 'measured'\n",
          bars.back().high * 1.05, bars.back().density / 4,
          2 * std::max(bars.front().density, std::max(programmed, measured)), programmed,
          programmed, style::kVermillion, measured, measured, style::kBlue);
  script.figure.caption = fmt::format(
      "Distribution of run times from poses (life table; runs that the end of a track cuts off are "
      "censored), from {} s, the shortest detectable run. Bars are one standard error.",
      shortText(runs.shortest));
  script.figure.csv = csvOf(bars, "s", 1);
  return script;
}

FigureScript turnsFigure(const Finding& finding) {
  const std::vector<DensityBar>& bars = finding.pool->result.runs->turns;
  FigureScript script = start(finding, "tumble_angles", "Tumble angles", bars);
  if (!script.figure.sentence.empty()) return script;
  DataBlock data("turns");
  double top = 0;
  double count = 0;
  for (const DensityBar& bar : bars) {
    data.row((bar.low + bar.high) / 2 * kDegrees, bar.density / kDegrees, bar.sigma / kDegrees);
    top = std::max(top, (bar.density + bar.sigma) / kDegrees);
    count += bar.count;
  }
  script.script =
      data.text() + style::preamble(script.figure.name, 760, 480) +
      fmt::format(
          "set xlabel 'tumble angle (°)'\nset ylabel 'probability density (1/°)' offset 0.5\n"
          "set xrange [-180:180]\nset xtics 90\nset yrange [0:{:.6g}]\nset key top right Right\n"
          "set boxwidth {:.6g}\nset style fill solid noborder\n"
          "plot $turns using 1:2 with boxes lc rgb '{}' title 'measured', "
          "$turns using 1:2:3 with yerrorbars pt 0 lw 1 lc rgb 'black' notitle, "
          "{:.8g} with lines lw 2 dt (8,5) lc rgb '{}' title 'uniform'\n",
          1.3 * top, 0.92 * (bars.front().high - bars.front().low) * kDegrees, style::kPaleGrey,
          1 / 360.0, style::kVermillion);
  script.figure.caption =
      fmt::format("Change of heading in {} between detected runs. Bars are one standard error.",
                  countText(static_cast<std::int64_t>(count), "single tumble"));
  script.figure.csv = csvOf(bars, "deg", kDegrees);
  return script;
}

}  // namespace lab::report
