#include "analyzer/report/figures/figure_crowd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/record/crowd_records.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using collective::CurveSample;
using collective::ObservableCurve;
using units::kCm;

/// A group of which curves are drawn.
struct Group {
  const CrowdRecord* crowd;
  std::string name;
  std::string colour;
};

std::vector<Group> groupsOf(const RunRecord& record) {
  std::vector<Group> groups;
  for (const CrowdRecord* one : shownCrowds(record)) {
    const CrowdRecord& crowd = *one;
    const auto program = static_cast<std::size_t>(std::max(0, crowd.program));
    const bool known = crowd.program >= 0 && program < record.programs.size();
    groups.push_back(
        {&crowd, crowdName(record, crowd), known ? record.programs[program].colour : "#202020"});
  }
  return groups;
}

const ObservableCurve* find(const CrowdRecord& crowd, const std::string& name) {
  for (const ObservableCurve& curve : crowd.result.curves) {
    if (curve.name == name) return &curve;
  }
  return nullptr;
}

/// Rows of the data of a curve in display units, for files.
void addRows(CsvText& csv, const Group& group, const ObservableCurve& curve) {
  const DisplayUnit x = displayUnit(curve.x_unit);
  const DisplayUnit y = displayUnit(curve.unit);
  const auto name = [](const DisplayUnit& unit) { return unit.text.empty() ? "1" : unit.text; };
  for (const CurveSample& p : curve.points) {
    csv.row(group.name, curve.name, p.x * x.factor, name(x), p.average.value * y.factor,
            p.average.sigma * y.factor, p.average.low * y.factor, p.average.high * y.factor,
            name(y), p.weight);
  }
}

std::string curvesCsv(const std::vector<Group>& groups, const std::vector<std::string>& names) {
  CsvText csv("robots,curve,x,x_unit,value,standard_error,low95,high95,unit,weight");
  for (const std::string& name : names) {
    for (const Group& group : groups) {
      if (const ObservableCurve* curve = find(*group.crowd, name)) addRows(csv, group, *curve);
    }
  }
  return csv.text();
}

/// Data blocks of a curve of every group, with intervals, and the plots of them.
struct Plots {
  std::string data;
  std::vector<std::string> bands;
  std::vector<std::string> lines;

  [[nodiscard]] bool empty() const { return lines.empty(); }
  [[nodiscard]] std::string text() const {
    return fmt::format("{}{}{}", fmt::join(bands, ", "), bands.empty() ? "" : ", ",
                       fmt::join(lines, ", "));
  }
};

Plots plotsOf(const std::vector<Group>& groups, const std::string& name, bool titled,
              bool positive = false) {
  Plots plots;
  int number = 0;
  for (const Group& group : groups) {
    const ObservableCurve* curve = find(*group.crowd, name);
    if (curve == nullptr) continue;
    const double x = displayUnit(curve->x_unit).factor;
    const double y = displayUnit(curve->unit).factor;
    const std::string block = fmt::format("{}_{}", name, number++);
    DataBlock data(block);
    DataBlock band(block + "_band");
    int points = 0;
    int with_band = 0;
    for (const CurveSample& p : curve->points) {
      if (!std::isfinite(p.average.value) || (positive && p.average.value <= 0)) continue;
      data.row(p.x * x, p.average.value * y);
      ++points;
      if (!std::isfinite(p.average.low)) continue;
      const double low = positive ? std::max(p.average.low, 0.02 * p.average.value) : p.average.low;
      band.row(p.x * x, low * y, p.average.high * y);
      ++with_band;
    }
    if (points == 0) continue;
    plots.data += data.text();
    if (with_band > 1) {
      plots.data += band.text();
      plots.bands.push_back(fmt::format(
          "${}_band using 1:2:3 with filledcurves fs transparent solid 0.25 noborder lc rgb '{}' "
          "notitle",
          block, group.colour));
    }
    plots.lines.push_back(fmt::format(
        "${} using 1:2 with linespoints pt 7 ps 0.25 lw 1.4 lc rgb '{}' {}", block, group.colour,
        titled ? "title " + gnuplotText(group.name) : std::string("notitle")));
  }
  return plots;
}

/// Two panels above each other with a common x axis, or one.
std::string panel(double bottom, double top) {
  return fmt::format("set tmargin at screen {:.3g}\nset bmargin at screen {:.3g}\n", top, bottom);
}

constexpr const char* kTwoPanels =
    "set multiplot\nset lmargin at screen (on_paper ? 0.20 : 0.13)\nset rmargin at screen 0.97\n";

/// A number over time: the average of each stretch with its 95 % interval.
Plots overTime(const std::vector<Group>& groups, collective::Scalar scalar, double scale,
               bool titled) {
  Plots plots;
  const std::string name(collective::nameOf(scalar).name);
  int number = 0;
  for (const Group& group : groups) {
    const std::string block = fmt::format("{}_{}", name, number++);
    DataBlock data(block);
    DataBlock band(block + "_band");
    int points = 0;
    int with_band = 0;
    for (const collective::Stretch& stretch : group.crowd->stretches) {
      const double value = stretch.values[scalar];
      const double sigma = stretch.sigmas[scalar];
      if (!std::isfinite(value)) continue;
      const double t = 0.5 * (stretch.begin + stretch.end) / scale;
      data.row(t, value);
      ++points;
      if (!std::isfinite(sigma)) continue;
      band.row(t, std::max(0.0, value - 2 * sigma), value + 2 * sigma);
      ++with_band;
    }
    if (points == 0) continue;
    plots.data += data.text();
    if (with_band > 1) {
      plots.data += band.text();
      plots.bands.push_back(fmt::format(
          "${}_band using 1:2:3 with filledcurves fs transparent solid 0.25 noborder lc rgb '{}' "
          "notitle",
          block, group.colour));
    }
    plots.lines.push_back(fmt::format("${} using 1:2 with lines lw 1.6 lc rgb '{}' {}", block,
                                      group.colour,
                                      titled ? "title " + gnuplotText(group.name) : "notitle"));
  }
  return plots;
}

std::string timeCsv(const std::vector<Group>& groups) {
  std::string header = "robots,from_s,to_s";
  for (std::size_t i = 0; i < collective::kScalars; ++i) {
    const auto name = collective::nameOf(static_cast<collective::Scalar>(i));
    const DisplayUnit unit = displayUnit(std::string(name.unit));
    const std::string column =
        fmt::format("{}{}{}", name.name, unit.key.empty() ? "" : "_", unit.key);
    header += fmt::format(",{0},standard_error_{0}", column);
  }
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n", header);
  for (const Group& group : groups) {
    for (const collective::Stretch& stretch : group.crowd->stretches) {
      fmt::format_to(std::back_inserter(text), "{},{:.7g},{:.7g}", group.name, stretch.begin,
                     stretch.end);
      for (std::size_t i = 0; i < collective::kScalars; ++i) {
        const auto unit = collective::nameOf(static_cast<collective::Scalar>(i)).unit;
        const double factor = displayUnit(std::string(unit)).factor;
        for (const double value : {stretch.values[i], stretch.sigmas[i]}) {
          text.push_back(',');
          if (std::isfinite(value)) {
            fmt::format_to(std::back_inserter(text), "{:.7g}", value * factor);
          }
        }
      }
      text.push_back('\n');
    }
  }
  return fmt::to_string(text);
}

FigureScript orderFigure(const RunRecord& record, const std::vector<Group>& groups) {
  FigureScript script = beginFigure("crowd_order", "Polar order and largest cluster over time");
  script.figure.csv = timeCsv(groups);
  const style::TimeAxis axis = style::timeAxis(record.duration());
  const Plots order = overTime(groups, collective::kPolar, axis.scale, true);
  const Plots cluster = overTime(groups, collective::kLargestCluster, axis.scale, order.empty());
  if (cluster.empty()) {
    script.figure.sentence = "Nothing over time: too few frames.";
    return script;
  }
  script.script =
      order.data + cluster.data + style::preamble(script.figure.name, 760, 640) + kTwoPanels;
  if (!order.empty()) {
    script.script += panel(0.56, 0.97) +
                     "set format x ''\nset yrange [0:1]\nset ylabel 'polar order'\nset key top "
                     "right\nplot " +
                     order.text() + "\nunset key\n";
  }
  script.script += panel(0.13, order.empty() ? 0.97 : 0.53) +
                   fmt::format(
                       "set format x '%g'\nset yrange [0:*]\nset xlabel 'time ({})'\n"
                       "set ylabel 'largest cluster (robots)'\nplot {}\nunset multiplot\n",
                       axis.unit, cluster.text());
  script.figure.caption =
      "Averages over equal stretches with two standard errors, which follow from the correlation "
      "time of the whole run.";
  return script;
}

FigureScript pairsFigure(const std::vector<Group>& groups) {
  FigureScript script =
      beginFigure("crowd_pairs", "Pair distribution g(r) and velocity correlation C_v(r)");
  script.figure.csv = curvesCsv(groups, {"pair_distribution", "velocity_correlation"});
  const Plots pairs = plotsOf(groups, "pair_distribution", true);
  const Plots velocities = plotsOf(groups, "velocity_correlation", false);
  if (pairs.empty()) {
    script.figure.sentence = "No pair distribution: never two robots at a time.";
    return script;
  }
  script.script =
      pairs.data + velocities.data + style::preamble(script.figure.name, 760, 640) + kTwoPanels;
  if (!velocities.empty()) {
    script.script += panel(0.56, 0.97) +
                     "set format x ''\nset xrange [0:*] writeback\nset yrange [0:*]\nset ylabel "
                     "'g(r)'\nplot " +
                     pairs.text() +
                     ", 1 with lines lw 1 dt (4,4) lc rgb '#808080' notitle\nunset key\nset "
                     "xrange restore\n" +
                     panel(0.13, 0.53) +
                     "set format x '%g'\nset yrange [*:*]\nset xlabel 'distance (cm)'\nset ylabel "
                     "'C_v(r)'\nplot " +
                     velocities.text() + ", 0 with lines lw 1 dt (4,4) lc rgb '#808080' notitle\n";
  } else {
    script.script += panel(0.13, 0.97) +
                     "set yrange [0:*]\nset xlabel 'distance (cm)'\nset ylabel 'g(r)'\nplot " +
                     pairs.text() + ", 1 with lines lw 1 dt (4,4) lc rgb '#808080' notitle\n";
  }
  script.script += "unset multiplot\n";
  script.figure.caption =
      "Shaded: 95 % intervals. Rings count with the part where centres of robots can be; without "
      "correlation g = 1 and C_v = 0 at every distance.";
  return script;
}

/// One panel with one or two curves of every group.
FigureScript simpleFigure(const char* name, const char* title, const std::vector<Group>& groups,
                          const std::string& curve, const std::string& settings,
                          const std::string& more, const char* caption, bool positive) {
  FigureScript script = beginFigure(name, title);
  script.figure.csv = curvesCsv(groups, {curve});
  const Plots plots = plotsOf(groups, curve, true, positive);
  if (plots.empty()) {
    script.figure.sentence = fmt::format("{}: nothing was observed.", title);
    return script;
  }
  script.script = plots.data + style::preamble(name, 760, 520) + settings + "plot " + plots.text() +
                  more + "\n";
  script.figure.caption = caption;
  return script;
}

FigureScript densityFigure(const std::vector<Group>& groups) {
  FigureScript script = simpleFigure(
      "crowd_density", "Distribution of the local packing fraction", groups, "density_of_cells",
      "set xrange [0:1]\nset yrange [0:*]\nset xlabel 'packing fraction of the Voronoi cell'\nset "
      "ylabel 'probability density'\n",
      "",
      "One value per robot and frame. Two peaks are a dilute and a dense phase. The file has also "
      "the share of boxes of about three diameters that robots cover.",
      false);
  script.figure.csv = curvesCsv(groups, {"density_of_cells", "density_of_boxes"});
  return script;
}

FigureScript clustersFigure(const std::vector<Group>& groups) {
  FigureScript script = simpleFigure(
      "crowd_clusters", "Sizes of clusters", groups, "cluster_sizes",
      "set logscale xy\nset format y '%g'\nset xlabel 'size of the cluster (robots)'\nset ylabel "
      "'share of robots per size'\n",
      "",
      "The share of robots that belong to a cluster of this size. The file has also the "
      "durations of contacts.",
      true);
  script.figure.csv = curvesCsv(groups, {"cluster_sizes", "contact_times"});
  return script;
}

/// The motion as it was filmed, with the free motion of the programs beside it.
FigureScript motionFigure(const RunRecord& record, const std::vector<Group>& groups) {
  FigureScript script = beginFigure("crowd_motion", "MSD of the whole motion beside the free one");
  script.figure.csv = curvesCsv(groups, {"whole_msd", "whole_angular_msd"});
  const Plots plots = plotsOf(groups, "whole_msd", true, true);
  if (plots.empty()) {
    script.figure.sentence = "No displacements: too few frames.";
    return script;
  }
  std::string data = plots.data;
  std::string free;
  for (const Finding& finding : findingsOf(record)) {
    DataBlock block(fmt::format("free_{}", finding.key));
    int points = 0;
    for (const analysis::CurvePoint& point : finding.pool->result.curves.msd) {
      if (point.windows <= 0 || !(point.value > 0)) continue;
      block.row(point.tau, point.value * kCm * kCm);
      ++points;
    }
    if (points == 0 || finding.key < 0) continue;
    data += block.text();
    free += fmt::format(", $free_{} using 1:2 with lines lw 1.6 dt (6,4) lc rgb '{}' title {}",
                        finding.key, finding.colour, gnuplotText(finding.name + ", free motion"));
  }
  script.script = data + style::preamble(script.figure.name, 760, 560) +
                  "set logscale xy\nset format y '%g'\nset key top left Left reverse\nset xlabel "
                  "'lag (s)'\nset ylabel 'MSD (cm²)'\nplot " +
                  plots.text() + free + "\n";
  script.figure.caption =
      "Points: everything that the camera saw, with contacts, reversals and stops, and 95 % "
      "intervals. Dashed: free motion, from which these are cut.";
  return script;
}

}  // namespace

std::vector<FigureScript> crowdFigures(const RunRecord& record) {
  if (!isCrowd(record)) return {};
  const std::vector<Group> groups = groupsOf(record);
  return {crowdArenaFigure(record),
          orderFigure(record, groups),
          pairsFigure(groups),
          densityFigure(groups),
          simpleFigure("crowd_fluctuations", "Number fluctuations", groups, "number_fluctuations",
                       "set logscale xy\nset format y '%g'\nset key top left Left reverse\nset "
                       "xlabel 'mean number of robots in a box'\nset ylabel 'variance of the "
                       "number'\n",
                       ", x with lines lw 1 dt (4,4) lc rgb '#808080' title 'without correlation'",
                       "Boxes of several sizes that tile the arena; the variance is corrected for "
                       "the given total number.",
                       true),
          crowdMapFigure(record),
          clustersFigure(groups),
          motionFigure(record, groups)};
}

}  // namespace lab::report
