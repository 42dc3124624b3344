#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using analysis::CurvePoint;

constexpr double kLimitZ = 4;
constexpr std::size_t kMostRobots = 30;  // largest number of robots whose curves are drawn

struct Quantity {
  const char* name;
  const char* title;
  const char* axis;
  const char* unit;  // in names of columns
  double factor;
  std::vector<CurvePoint> analysis::Curves::*curve;
};

constexpr Quantity kMsd{"msd", "Mean-squared displacement", "MSD (cm²)", "cm2",
                        1e4,   &analysis::Curves::msd};
constexpr Quantity kAngular{"angular_msd",
                            "Angular mean-squared displacement",
                            "angular MSD (rad²)",
                            "rad2",
                            1,
                            &analysis::Curves::angular_msd};

bool drawable(const CurvePoint& point) {
  return point.windows > 0 && std::isfinite(point.value) && point.value > 0 && point.tau > 0;
}

constexpr double kFewestWindows = 10;  // behind a point of a single robot's curve

/// A data block with one nan row, because gnuplot rejects empty blocks.
DataBlock emptyBlock(const char* name) {
  using units::kNan;
  DataBlock block(name);
  block.row(kNan, kNan, kNan, kNan);
  return block;
}

/// What is drawn of one curve.
struct CurveData {
  DataBlock judged = emptyBlock("judged");
  DataBlock open = emptyBlock("open");
  DataBlock law = emptyBlock("law");
  DataBlock paper = emptyBlock("paper");
  DataBlock paper_z = emptyBlock("paper_z");
  DataBlock z = emptyBlock("z");
  DataBlock z_open = emptyBlock("z_open");
  DataBlock robots = emptyBlock("robots");
  bool has_judged = false;
  bool has_open = false;
  bool has_law = false;
  std::string law_title;
  bool has_paper = false;
  bool has_robots = false;
  double largest_z = kLimitZ;
  double first = 1e300;  ///< [s] lags
  double last = 0;

  void add(const CurvePoint& point, double factor);
  [[nodiscard]] std::string text() const;
};

void CurveData::add(const CurvePoint& point, double factor) {
  first = std::min(first, point.tau);
  last = std::max(last, point.tau);
  // The error bar ends above 0, for the logarithmic axis.
  constexpr double kLeastShare = 0.02;
  const double sigma = std::isfinite(point.sigma) ? point.sigma : 0;
  const double low = std::max(point.value - sigma, kLeastShare * point.value);
  (point.judged ? judged : open)
      .row(point.tau, point.value * factor, low * factor, (point.value + sigma - low) * factor);
  (point.judged ? has_judged : has_open) = true;
  if (std::isfinite(point.exact)) {
    law.row(point.tau, (point.exact + point.noise) * factor);
    has_law = true;
  }
  if (std::isfinite(point.paper)) {
    paper.row(point.tau, point.paper * factor);
    has_paper = true;
    if (sigma > 0 && point.judged) paper_z.row(point.tau, (point.paper - point.exact) / sigma);
  }
  if (std::isfinite(point.z)) {
    (point.judged ? z : z_open).row(point.tau, point.z);
    if (point.judged) largest_z = std::max(largest_z, std::abs(point.z));
  }
}

std::string CurveData::text() const {
  std::string all;
  for (const DataBlock* block : {&judged, &open, &law, &paper, &paper_z, &z, &z_open, &robots}) {
    all += block->text();
  }
  return all;
}

CurveData collect(const Finding& finding, const Quantity& quantity) {
  CurveData data;
  data.law_title = finding.pool->result.law->reference().substr(std::string("the ").size());
  for (const CurvePoint& point : finding.pool->result.curves.*quantity.curve) {
    if (drawable(point)) data.add(point, quantity.factor);
  }
  data.has_robots = finding.robots.size() > 1 && finding.robots.size() <= kMostRobots;
  if (!data.has_robots) return data;
  for (const analysis::FeedResult* robot : finding.robots) {
    for (const CurvePoint& point : robot->result.curves.*quantity.curve) {
      if (!drawable(point) || point.windows < kFewestWindows) continue;
      data.robots.row(point.tau, point.value * quantity.factor);
    }
    data.robots.blank();
  }
  return data;
}

/// The curve with its laws, doubly logarithmic.
std::string upperPanel(const CurveData& data, const Quantity& quantity) {
  // Without a law there is no panel of deviations below it.
  std::string script = fmt::format(
      "set logscale xy\nset format y '%g'\nset tmargin at screen 0.97\n{}"
      "set xrange [{:.6g}:{:.6g}]\nset ylabel '{}' offset 0.5\nset key top left Left reverse\n"
      "plot ",
      data.has_law ? "set format x ''\nset bmargin at screen 0.40\n"
                   : "set format x '%g'\nset bmargin at screen (on_paper ? 0.18 : 0.13)\nset "
                     "xlabel 'lag (s)'\n",
      data.first / 1.4, data.last * 1.4, quantity.axis);
  std::vector<std::string> plots;
  if (data.has_robots) {
    plots.emplace_back("$robots using 1:2 with lines lw 0.8 lc rgb '#C8C8C8' title 'each robot'");
  }
  if (data.has_open) {
    plots.emplace_back(
        "$open using 1:3:(0):4 with vectors nohead lw 1 lc rgb '#808080' notitle, "
        "$open using 1:2 with points pt 6 ps 0.5 lw 1 lc rgb '#707070' title 'measured, not "
        "judged'");
  }
  if (data.has_judged) {
    plots.emplace_back(
        "$judged using 1:3:(0):4 with vectors nohead lw 1.2 lc rgb 'black' notitle, "
        "$judged using 1:2 with points pt 7 ps 0.5 lc rgb 'black' title 'measured'");
  }
  if (data.has_paper) {
    plots.push_back(
        fmt::format("$paper using 1:2 with lines lw 2 dt (8,5) lc rgb '{}' title 'paper’s formula'",
                    style::kVermillion));
  }
  if (data.has_law) {
    plots.push_back(fmt::format("$law using 1:2 with lines lw 1.6 lc rgb '{}' title \"{}\"",
                                style::kBlue, data.law_title));
  }
  return script + fmt::format("{}\n", fmt::join(plots, ", "));
}

/// The deviation in standard errors.
std::string lowerPanel(const CurveData& data) {
  const double range = std::clamp(data.largest_z * 1.25, 6.0, 14.0);
  return fmt::format(
      "unset logscale y\nset format x '%g'\nset tmargin at screen 0.36\n"
      "set bmargin at screen (on_paper ? 0.18 : 0.13)\nunset key\nset xlabel 'lag (s)'\n"
      "set ylabel 'deviation (σ)' offset 0.5\nset yrange [-{0:.4g}:{0:.4g}]\nset ytics {1}\n"
      "set object 2 rectangle from graph 0,first -2 to graph 1,first 2 behind fs solid noborder "
      "fc rgb '#E8EFF5'\n"
      "plot {2} with lines lw 1 dt (4,4) lc rgb '#808080', "
      "-{2} with lines lw 1 dt (4,4) lc rgb '#808080', "
      "$paper_z using 1:2 with lines lw 2 dt (8,5) lc rgb '{3}', "
      "0 with lines lw 1.6 lc rgb '{4}', "
      "$z_open using 1:2 with points pt 6 ps 0.5 lw 1 lc rgb '#707070', "
      "$z using 1:2 with points pt 7 ps 0.5 lc rgb 'black'\n",
      range, range > 8 ? 4 : 2, kLimitZ, style::kVermillion, style::kBlue);
}

std::string curveScript(const Finding& finding, const Quantity& quantity, const std::string& file) {
  const CurveData data = collect(finding, quantity);
  return data.text() + style::preamble(file, 760, 640) +
         "set multiplot\nset lmargin at screen (on_paper ? 0.24 : 0.15)\n"
         "set rmargin at screen 0.97\n" +
         upperPanel(data, quantity) + (data.has_law ? lowerPanel(data) : "") + "unset multiplot\n";
}

std::string curveCsv(const std::vector<CurvePoint>& points, const Quantity& quantity) {
  CsvText csv(fmt::format(
      "lag_s,value_{0},standard_error_{0},noise_{0},exact_{0},paper_{0},z,windows,judged",
      quantity.unit));
  const double factor = quantity.factor;
  for (const CurvePoint& p : points) {
    if (!drawable(p)) continue;
    csv.row(p.tau, p.value * factor, p.sigma * factor, p.noise * factor, p.exact * factor,
            p.paper * factor, p.z, p.windows, p.judged);
  }
  return csv.text();
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
  script.figure.csv = curveCsv(points, quantity);
  return script;
}

/// A line of slope 1 or 2 beside the curves, with its exponent.
std::string slopeGuide(const char* label, int exponent, double begin, double end, double value) {
  return fmt::format(
      "set arrow from {:.6g},{:.6g} to {:.6g},{:.6g} nohead lw 1 lc rgb '#606060'\n"
      "set label '{}' at {:.6g},{:.6g} right offset -0.5,0.2 tc rgb '#606060'\n",
      begin, value, end, value * std::pow(end / begin, exponent), label, end,
      value * std::pow(end / begin, exponent));
}

/// What the overview draws of all programs.
struct Overview {
  std::string data;
  std::vector<std::string> curves;   ///< elements of the upper plot
  std::vector<std::string> symbols;  ///< elements that lie above the lines
  std::vector<std::string> deviations;
  double first = 1e300;  ///< [s] lags
  double last = 0;
  double first_value = 0;  ///< [cm^2] the largest at the first and at the last lag
  double last_value = 0;
  double least_value = 1e300;
  double largest_z = kLimitZ;

  void add(std::size_t index, const Finding& finding);
};

void Overview::add(std::size_t index, const Finding& finding) {
  const CurveData own = collect(finding, kMsd);
  if (!(own.last > 0)) return;
  std::string text = own.text();
  for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at + 1)) {
    text.insert(at + 1, fmt::format("p{}_", index));
  }
  data += text;
  const std::string_view colour = finding.colour;
  const std::string block = fmt::format("$p{}_", index);
  if (own.has_robots) {
    curves.push_back(fmt::format("{}robots using 1:2 with lines lw 0.6 lc rgb '#B0{}' notitle",
                                 block, colour.substr(1)));
  }
  if (own.has_law) {
    symbols.push_back(
        fmt::format("{}law using 1:2 with lines lw 1.6 lc rgb '{}' notitle", block, colour));
    deviations.push_back(
        fmt::format("{}z using 1:2 with points pt 7 ps 0.5 lc rgb '{}'", block, colour));
  }
  if (own.has_open) {
    symbols.push_back(fmt::format(
        "{}open using 1:2 with points pt 6 ps 0.5 lw 1 lc rgb '{}' notitle", block, colour));
  }
  symbols.push_back(
      fmt::format("{0}judged using 1:3:(0):4 with vectors nohead lw 1.2 lc rgb '{1}' notitle, "
                  "{0}judged using 1:2 with points pt 7 ps 0.6 lc rgb '{1}' title {2}",
                  block, colour, gnuplotText(finding.name)));
  first = std::min(first, own.first);
  last = std::max(last, own.last);
  largest_z = std::max(largest_z, own.largest_z);
  for (const CurvePoint& point : finding.pool->result.curves.msd) {
    if (!drawable(point)) continue;
    least_value = std::min(least_value, point.value * kMsd.factor);
    double& value = point.tau < 1.01 * own.first ? first_value : last_value;
    if (point.tau < 1.01 * own.first || point.tau > 0.5 * own.last) {
      value = std::max(value, point.value * kMsd.factor);
    }
  }
}

}  // namespace

FigureScript msdOverview(const std::vector<Finding>& findings) {
  FigureScript script;
  script.figure.name = "msd";
  script.figure.title = "Mean-squared displacement with its law";
  Overview all;
  CsvText csv("program,lag_s,value_cm2,standard_error_cm2,noise_cm2,exact_cm2,z,judged");
  for (std::size_t i = 0; i < findings.size(); ++i) {
    all.add(i, findings[i]);
    for (const CurvePoint& p : findings[i].pool->result.curves.msd) {
      if (!drawable(p)) continue;
      csv.row(findings[i].name, p.tau, p.value * kMsd.factor, p.sigma * kMsd.factor,
              p.noise * kMsd.factor, p.exact * kMsd.factor, p.z, p.judged);
    }
  }
  if (all.symbols.empty()) {
    script.figure.sentence = "Mean-squared displacement: too little motion for a curve.";
    return script;
  }
  script.figure.csv = csv.text();
  all.curves.insert(all.curves.end(), all.symbols.begin(), all.symbols.end());
  const bool has_law = !all.deviations.empty();
  const double range = std::clamp(all.largest_z * 1.25, 6.0, 14.0);
  script.script =
      all.data + style::preamble(script.figure.name, 560, 630) +
      fmt::format(
          "set multiplot\nset lmargin at screen (on_paper ? 0.24 : 0.17)\n"
          "set rmargin at screen 0.97\nset logscale xy\nset format y '%g'\n"
          "set tmargin at screen 0.97\n{}set xrange [{:.6g}:{:.6g}]\n"
          "set yrange [{:.6g}:{:.6g}]\nset ylabel 'MSD (cm²)' offset 0.5\n"
          "set key bottom right Right\n",
          has_law ? "set format x ''\nset bmargin at screen 0.38\n"
                  : "set format x '%g'\nset bmargin at screen 0.14\nset xlabel 'lag (s)'\n",
          all.first / 1.4, all.last * 1.4, all.least_value / 2.5, 10 * all.last_value) +
      slopeGuide("∝ lag²", 2, all.first, 4 * all.first, 2.5 * all.first_value) +
      slopeGuide("∝ lag", 1, all.last / 5, all.last / 1.2, 0.9 * all.last_value) +
      fmt::format("plot {}\nunset arrow\nunset label\n", fmt::join(all.curves, ", "));
  if (has_law) {
    script.script += fmt::format(
        "unset logscale y\nset format x '%g'\nset tmargin at screen 0.34\n"
        "set bmargin at screen (on_paper ? 0.18 : 0.14)\nunset key\nset xlabel 'lag (s)'\n"
        "set ylabel 'deviation (σ)' offset 0.5\nset yrange [-{0:.4g}:{0:.4g}]\nset ytics 4\n"
        "set object 2 rectangle from graph 0,first -2 to graph 1,first 2 behind fs solid noborder "
        "fc rgb '#E8EFF5'\n"
        "plot {1} with lines lw 1 dt (4,4) lc rgb '#808080', "
        "-{1} with lines lw 1 dt (4,4) lc rgb '#808080', 0 with lines lw 1.2 lc rgb '#404040', "
        "{2}\n",
        range, kLimitZ, fmt::join(all.deviations, ", "));
  }
  script.script += "unset multiplot\n";
  script.figure.caption =
      "Points: measured, all robots together, with one standard error; hollow: not judged. Pale "
      "lines: each robot. Solid lines: what each is compared with (its exact law, its formulas or "
      "simulated recordings). Below: the deviation from it in standard errors; 4 is the limit.";
  return script;
}

FigureScript msdFigure(const Finding& finding) { return curveFigure(finding, kMsd); }
FigureScript angularMsdFigure(const Finding& finding) { return curveFigure(finding, kAngular); }

}  // namespace lab::report
