#include <algorithm>
#include <cmath>

#include "report/figure_scripts.hpp"
#include "report/gnuplot.hpp"
#include "report/people.hpp"

namespace lab::report {
namespace {

using analysis::CurvePoint;

constexpr double kLimitZ = 4;
constexpr std::size_t kMostRobots = 30;  // whose own curves are drawn

struct Quantity {
  const char* name;
  const char* title;
  const char* axis;
  double factor;
  std::vector<CurvePoint> analysis::Curves::*curve;
};

constexpr Quantity kMsd{"msd", "Mean-squared displacement", "MSD (cm²)", 1e4,
                        &analysis::Curves::msd};
constexpr Quantity kAngular{"angular_msd", "Angular mean-squared displacement",
                            "angular MSD (rad²)", 1, &analysis::Curves::angular_msd};

bool drawable(const CurvePoint& point) {
  return point.windows > 0 && std::isfinite(point.value) && point.value > 0 && point.tau > 0;
}

/// The error bar on a logarithmic axis: it ends above 0.
void addMeasured(DataBlock& data, const CurvePoint& point, double factor) {
  constexpr double kLeastShare = 0.02;
  const double sigma = std::isfinite(point.sigma) ? point.sigma : 0;
  data.row(point.tau, point.value * factor,
           std::max(point.value - sigma, kLeastShare * point.value) * factor,
           (point.value + sigma) * factor);
}

/// Smooth lines through the laws, and what the eye needs to compare.
std::string curveScript(const Finding& finding, const Quantity& quantity, const std::string& file) {
  const std::vector<CurvePoint>& points = finding.pool->result.curves.*quantity.curve;
  DataBlock judged("judged");
  DataBlock open("open");
  DataBlock law("law");
  DataBlock paper("paper");
  DataBlock z("z");
  DataBlock z_open("z_open");
  bool has_paper = false;
  bool has_open = false;
  double largest_z = kLimitZ;
  double first = 1e300;
  double last = 0;
  // A block may not be empty.
  for (DataBlock* block : {&judged, &open, &law, &paper, &z, &z_open}) {
    block->row(std::nan(""), std::nan(""), std::nan(""), std::nan(""));
  }
  for (const CurvePoint& point : points) {
    if (!drawable(point)) continue;
    first = std::min(first, point.tau);
    last = std::max(last, point.tau);
    addMeasured(point.judged ? judged : open, point, quantity.factor);
    has_open = has_open || !point.judged;
    if (std::isfinite(point.exact)) {
      law.row(point.tau, (point.exact + point.noise) * quantity.factor);
    }
    if (std::isfinite(point.paper)) {
      paper.row(point.tau, point.paper * quantity.factor);
      has_paper = true;
    }
    if (std::isfinite(point.z)) {
      (point.judged ? z : z_open).row(point.tau, point.z);
      if (point.judged) largest_z = std::max(largest_z, std::abs(point.z));
    }
  }
  DataBlock robots("robots");
  robots.row(std::nan(""), std::nan(""));
  const bool show_robots = finding.robots.size() > 1 && finding.robots.size() <= kMostRobots;
  if (show_robots) {
    for (const analysis::FeedResult* robot : finding.robots) {
      for (const CurvePoint& point : robot->result.curves.*quantity.curve) {
        if (drawable(point)) robots.row(point.tau, point.value * quantity.factor);
      }
      robots.blank();
    }
  }
  const double z_range = std::min(12.0, largest_z * 1.25);
  std::string script;
  for (const DataBlock* block : {&judged, &open, &law, &paper, &z, &z_open, &robots}) {
    script += block->text();
  }
  script += style::preamble(file, 760, 640);
  script += fmt::format(
      "set multiplot\nset logscale xy\nset format '%g'\n"
      "set lmargin at screen 0.15\nset rmargin at screen 0.97\n"
      "set xrange [{:.6g}:{:.6g}]\n"
      "set tmargin at screen 0.97\nset bmargin at screen 0.40\n"
      "set ylabel '{}' offset 0.5\nset format x ''\nset key top left\n",
      first / 1.4, last * 1.4, quantity.axis);
  script += fmt::format("plot {}", show_robots ? "$robots using 1:2 with lines lw 0.8 lc rgb "
                                                 "'#C4C4C4' title 'each robot', \\\n  "
                                               : "");
  if (has_paper) {
    script += fmt::format(
        "$paper using 1:2 with lines lw 2 dt (8,5) lc rgb '{}' title 'paper’s formula', \\\n  ",
        style::kVermillion);
  }
  script += fmt::format(
      "$law using 1:2 with lines lw 2 lc rgb '{}' title 'exact law', \\\n"
      "  $judged using 1:2:3:4 with yerrorbars pt 7 ps 0.45 lw 1.2 lc rgb 'black' title 'measured'",
      style::kBlue);
  if (has_open) {
    script +=
        ", \\\n  $open using 1:2:3:4 with yerrorbars pt 6 ps 0.45 lw 1 lc rgb '#707070' title "
        "'measured, not judged'";
  }
  script += fmt::format(
      "\nunset logscale y\nset tmargin at screen 0.36\nset bmargin at screen 0.12\n"
      "set format '%g'\nunset key\nset xlabel 'lag (s)'\n"
      "set ylabel 'deviation (σ)' offset 0.5\nset yrange [{:.4g}:{:.4g}]\n"
      "set ytics {}\n"
      "set object 2 rectangle from graph 0,first -{} to graph 1,first {} behind fs solid noborder "
      "fc rgb '#EEF3F7'\n"
      "plot 0 with lines lw 1.2 lc rgb '{}', {} with lines lw 1 dt (4,4) lc rgb '#808080', "
      "-{} with lines lw 1 dt (4,4) lc rgb '#808080', \\\n"
      "  $z_open using 1:2 with points pt 6 ps 0.45 lw 1 lc rgb '#707070', \\\n"
      "  $z using 1:2 with points pt 7 ps 0.45 lc rgb 'black'\n"
      "unset multiplot\n",
      -z_range, z_range, z_range > 8 ? 4 : 2, 2, 2, style::kBlue, kLimitZ, kLimitZ);
  return script;
}

FigureScript curveFigure(const Finding& finding, const Quantity& quantity) {
  FigureScript script;
  script.figure.name = fmt::format("{}_{}", quantity.name, finding.file);
  script.figure.title = fmt::format("{} of {}", quantity.title, finding.name);
  const auto& points = finding.pool->result.curves.*quantity.curve;
  const auto count = std::count_if(points.begin(), points.end(), drawable);
  if (count < 2) {
    script.figure.sentence =
        fmt::format("{}: too little motion under {} for a curve ({} of free motion).",
                    quantity.title, finding.name, durationText(finding.pool->result.observed));
    return script;
  }
  script.script = curveScript(finding, quantity, script.figure.name);
  script.figure.caption =
      "Points: measured, with one standard error. Solid: the exact law of what the robot executes, "
      "tracker noise included. Dashed: the paper’s formula. Below: the deviation from the exact "
      "law "
      "in standard errors; beyond the dashed lines it is a disagreement. Neighbouring lags share "
      "their data and wander together.";
  return script;
}

}  // namespace

FigureScript msdFigure(const Finding& finding) { return curveFigure(finding, kMsd); }
FigureScript angularMsdFigure(const Finding& finding) { return curveFigure(finding, kAngular); }

}  // namespace lab::report
