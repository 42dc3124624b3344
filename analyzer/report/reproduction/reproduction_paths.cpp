#include "analyzer/report/reproduction/reproduction_paths.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "common/text/format.hpp"

namespace lab::report::panels {
namespace {

constexpr int kColours = 24;

struct Box {
  double left, right, bottom, top;  // of the screen
};

struct Range {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double middle() const { return (low + high) / 2; }
};

/// Commands that make a box show all points at equal scales.
std::string frame(const std::vector<PathPoint>& points, const Box& box) {
  Range x;
  Range y;
  for (const PathPoint& point : points) {
    x.add(point.x);
    y.add(point.y);
  }
  const double width = (box.right - box.left) * kWidth;
  const double height = (box.top - box.bottom) * kHeight;
  constexpr double kMargin = 1.08;
  const double scale =
      kMargin * std::max({(x.high - x.low) / width, (y.high - y.low) / height, 1e-6}) / 2;
  return fmt::format(
      "set lmargin at screen {:.4g} + 0.04 * on_paper\nset rmargin at screen {:.4g}\nset bmargin "
      "at screen {:.4g}\n"
      "set tmargin at screen {:.4g}\nset xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n",
      box.left, box.right, box.bottom, box.top, x.middle() - scale * width,
      x.middle() + scale * width, y.middle() - scale * height, y.middle() + scale * height);
}

/// Distance of tics [cm], for about three tics.
double tic(const std::vector<PathPoint>& points) {
  Range x;
  Range y;
  for (const PathPoint& point : points) {
    x.add(point.x);
    y.add(point.y);
  }
  const double span = std::max({x.high - x.low, (y.high - y.low) / 2, 1e-3});
  const double power = std::pow(10, std::floor(std::log10(span)));
  return span / power >= 5 ? 5 * power : span / power >= 2 ? 2 * power : power;
}

/// Adds the path as blocks of one colour each. @return the plot elements.
std::string colouredPath(const std::vector<PathPoint>& path, double scale, std::string& data) {
  std::string plots;
  const double begin = path.front().t;
  const double length = std::max(1e-9, path.back().t - begin);
  std::size_t i = 0;
  for (int bin = 0; bin < kColours; ++bin) {
    DataBlock block(fmt::format("path{}", bin));
    const double end = begin + length * (bin + 1) / kColours;
    if (i > 0) --i;  // no gap between colours
    std::size_t rows = 0;
    for (; i < path.size() && (path[i].t <= end || bin + 1 == kColours); ++i, ++rows) {
      block.row(path[i].x, path[i].y);
    }
    if (rows == 0) continue;
    data += block.text();
    plots += fmt::format("{}$path{} using 1:2 with lines lw 1 lc palette cb {:.6g} notitle",
                         plots.empty() ? "" : ", ", bin,
                         (begin + length * (bin + 0.5) / kColours) / scale);
  }
  return plots;
}

}  // namespace

FigureScript trajectory(const PaperPanel& panel, const SetData& set) {
  FigureScript script;
  script.figure.name = "fig" + panel.id;
  script.figure.title = fmt::format("Figure {}. {}", panel.id, panel.title);
  const RecordingData& recording = set.recordings.front();
  if (recording.path.size() < 2 || recording.close_up.size() < 2) {
    script.figure.sentence = "Too short a recording for a trajectory.";
    return script;
  }
  const double duration = recording.path.back().t - recording.path.front().t;
  const style::TimeAxis axis = style::timeAxis(duration);
  std::string data;
  const std::string plots = colouredPath(recording.path, axis.scale, data);
  DataBlock close("close");
  for (const PathPoint& point : recording.close_up) close.row(point.x, point.y);
  script.script = data + close.text() + style::preamble(script.figure.name, kWidth, kHeight);
  script.script += fmt::format(
      "unset key\nset multiplot\n"
      "set palette maxcolors {} defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', "
      "4 '#7ad151', 5 '#d8d020')\n"
      "set cbrange [{:.6g}:{:.6g}]\nset colorbox horizontal user origin 0.17,0.93 size 0.60,0.025\n"
      "set cbtics font small_font\nset label 2 'time ({})' at screen 0.80,0.94 left font "
      "small_font\n"
      "set xlabel 'x (cm)'\nset ylabel 'y (cm)' offset 0.5\nset xtics {:.4g}\nset ytics {:.4g}\n"
      "{}plot {}\nunset label 2\n",
      kColours, recording.path.front().t / axis.scale, recording.path.back().t / axis.scale,
      axis.unit, tic(recording.path), tic(recording.path),
      frame(recording.path, {0.17, 0.66, 0.16, 0.83}), plots);
  script.script += fmt::format(
      "unset colorbox\nset tics font small_font\nset xlabel '' \nset ylabel ''\n"
      "set label 1 '{:.0f} s enlarged' at screen 0.87,0.81 center font small_font\n"
      "{}"
      "set xtics {:.4g}\nset ytics {:.4g}\n"
      "plot $close using 1:2 with lines lw 1 lc rgb '{}', "
      "$close using 1:2 every {} with points pt 7 ps 0.3 lc rgb '{}'\nunset multiplot\n",
      recording.close_up.back().t - recording.close_up.front().t,
      frame(recording.close_up, {0.775, 0.965, 0.16, 0.77}), tic(recording.close_up),
      tic(recording.close_up), style::kBlue, 10, style::kVermillion);
  CsvText csv("part,t_s,x_cm,y_cm");
  for (const PathPoint& p : recording.path) csv.row("whole", p.t, p.x, p.y);
  for (const PathPoint& p : recording.close_up) csv.row("enlarged", p.t, p.x, p.y);
  script.figure.csv = csv.text();
  script.figure.caption = fmt::format(
      "{} of free motion, stitched across {} at walls; beside it a part, a dot each 0.2 s.",
      durationText(duration), countText(recording.result.reversals, "reversal"));
  return script;
}

FigureScript runsAndTumbles(const PaperPanel& panel, const SetData& set) {
  FigureScript script;
  script.figure.name = "fig" + panel.id;
  script.figure.title = fmt::format("Figure {}. {}", panel.id, panel.title);
  const RecordingData& recording = set.recordings.front();
  if (recording.speeds.size() < 100 || recording.run_times.size() < 10) {
    script.figure.sentence = "Too short a recording for speeds and run times.";
    return script;
  }
  const auto law = recording.result.law->runs().value_or(analysis::RunsAndTurns{});
  constexpr double kTrace = 20;       // [s]
  constexpr double kSpeedBin = 0.25;  // [cm/s]
  CsvText csv("what,x,value,standard_error,exact");
  DataBlock trace("trace");
  const double begin = recording.speeds.front().t;
  for (const SpeedPoint& point : recording.speeds) {
    if (point.t > begin + kTrace) break;
    trace.row(point.t - begin, point.speed);
    csv.row("speed_cm_s_at_t_s", point.t - begin, point.speed, "", "");
  }
  std::vector<double> histogram(32);
  for (const SpeedPoint& point : recording.speeds) {
    const auto bin = static_cast<std::size_t>(point.speed / kSpeedBin);
    if (bin < histogram.size()) histogram[bin] += 1;
  }
  DataBlock speeds("speeds");
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const double density = histogram[i] / static_cast<double>(recording.speeds.size()) / kSpeedBin;
    speeds.row((static_cast<double>(i) + 0.5) * kSpeedBin, density);
    csv.row("density_s_cm_at_speed_cm_s", (static_cast<double>(i) + 0.5) * kSpeedBin, density, "",
            "");
  }
  const double run_bin = 0.5 / law.rate;
  std::vector<double> counts(12);
  for (const double run : recording.run_times) {
    const auto bin = static_cast<std::size_t>(std::max(0.0, run) / run_bin);
    if (bin < counts.size()) counts[bin] += 1;
  }
  DataBlock runs("runs");
  const double unit = 1 / (static_cast<double>(recording.run_times.size()) * run_bin);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double from = static_cast<double>(i) * run_bin;
    const double exact =
        (std::exp(-law.rate * from) - std::exp(-law.rate * (from + run_bin))) / run_bin;
    const double error = std::sqrt(counts[i]) * unit;
    csv.row("density_per_s_at_run_time_s", from + run_bin / 2, counts[i] * unit, error, exact);
    if (counts[i] == 0) continue;
    runs.row(from + run_bin / 2, counts[i] * unit,
             std::max(0.02, 1 - 1 / std::sqrt(counts[i])) * counts[i] * unit,
             counts[i] * unit + error);
  }
  script.script = trace.text() + speeds.text() + runs.text() +
                  style::preamble(script.figure.name, kWidth, kHeight);
  script.script += fmt::format(
      "unset key\nset multiplot\nset lmargin at screen 0.17 + 0.04 * on_paper\nset rmargin at "
      "screen 0.965\n"
      "set tmargin at screen 0.965\nset bmargin at screen 0.68\nset xlabel 'time (s)' offset "
      "0,0.5\n"
      "set ylabel 'speed (cm/s)' offset 0.5\nset yrange [0:7.5]\nset xrange [0:{:.4g}]\n"
      "plot {:.5g} with lines lw 1 dt (6,4) lc rgb 'black', "
      "$trace using 1:2 with lines lw 1.2 lc rgb '{}'\n"
      "set tmargin at screen 0.51\nset bmargin at screen 0.16\n"
      "set rmargin at screen 0.49\nset xlabel 'speed (cm/s)' offset 0,0\n"
      "set ylabel 'density (s/cm)' offset 0.5\nset xrange [-0.3:7.5]\nset yrange [0:*]\nset xtics "
      "2.5\n"
      "set boxwidth 0.25\n"
      "plot $speeds using 1:2 with boxes lc rgb '{}' fs solid 0.5\n",
      kTrace, law.speed * 100, style::kBlue, style::kBlue);
  script.script += fmt::format(
      "set lmargin at screen 0.68 + 0.03 * on_paper\nset rmargin at screen 0.965\nset xlabel 'run "
      "time (s)'\n"
      "set ylabel 'density (1/s)' offset 1\nset logscale y\nset yrange [{:.3g}:{:.3g}]\n"
      "set xrange [0:{:.4g}]\nset xtics {:.4g}\nset format y '%g'\n"
      "plot {:.6g}*exp(-{:.6g}*x) with lines lw 1.6 lc rgb 'black', "
      "$runs using 1:3:(0):($4-$3) with vectors nohead lw 1.2 lc rgb '{}', "
      "$runs using 1:2 with points pt 7 ps 0.5 lc rgb '{}'\nunset multiplot\n",
      law.rate * 2e-3, law.rate * 2, 6 / law.rate, law.rate > 1.5 ? 1.0 : 2.0, law.rate, law.rate,
      style::kBlue, style::kBlue);
  script.figure.csv = csv.text();
  script.figure.caption = fmt::format(
      "Above: speed over 0.1 s, dashed the programmed one. Below: all speeds of the recording, and "
      "{} "
      "as the robot counted them, beside γ exp(-γ τ_r).",
      countText(static_cast<std::int64_t>(recording.run_times.size()), "run time"));
  return script;
}

}  // namespace lab::report::panels
