#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/figures/thinning.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using units::kCm;

constexpr std::size_t kPoints = 4500;
constexpr int kColours = 24;
constexpr std::size_t kMostNumbers = 24;  // robots whose numbers are drawn

/// Arena outline, equal scales, axes in cm.
std::string arena(const RunRecord& record) {
  const Experiment& experiment = record.experimentOrDefault();
  const double width = experiment.arena_width * kCm;
  const double height = experiment.arena_height * kCm;
  const double margin = 0.015 * std::max(width, height);
  return fmt::format(
      "set size ratio -1\nset border 0\nset tics out\n"
      "set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n"
      "set xlabel 'x (cm)'\nset ylabel 'y (cm)' offset 0.5\n"
      "set object 1 rectangle from 0,0 to {:.6g},{:.6g} fs empty border lc rgb '#606060' lw 1.5\n",
      -margin, width + margin, -margin, height + margin, width, height);
}

std::set<int> robotsOf(const PlotTracks& plot) {
  std::set<int> robots;
  for (const PlotLine& line : plot.lines) robots.insert(line.robot);
  return robots;
}

/// The first place of each robot, with its number.
std::string startsOf(const PlotTracks& plot) {
  DataBlock starts("starts");
  std::set<int> seen;
  for (const PlotLine& line : plot.lines) {
    if (!seen.insert(line.robot).second) continue;
    starts.row(line.points.front().x, line.points.front().y, static_cast<double>(line.robot));
  }
  return starts.text();
}

std::string whichPart(const RunRecord& record, const PlotTracks& plot) {
  const std::set<int> robots = robotsOf(plot);
  const std::string who = robots.size() == 1
                              ? fmt::format("Robot {}", *robots.begin())
                              : countText(static_cast<std::int64_t>(robots.size()), "robot");
  if (plot.whole_run) return fmt::format("{}, the whole run.", who);
  return fmt::format("{}, from {} to {} of {}: more would not be legible.", who,
                     durationText(std::max(0.0, plot.begin)), durationText(plot.end),
                     durationText(record.duration()));
}

bool nothingToDraw(const PlotTracks& plot) {
  return std::none_of(plot.lines.begin(), plot.lines.end(),
                      [](const PlotLine& line) { return line.points.size() > 1; });
}

void addLine(DataBlock& data, const PlotLine& line, double colour) {
  for (const PlotPoint& point : line.points) data.row(point.x, point.y, colour);
  data.blank();
}

std::string trackCsv(const RunRecord& record, const PlotTracks& plot) {
  CsvText csv("particle,line,program,free,t_s,x_cm,y_cm");
  int number = 0;
  for (const PlotLine& line : plot.lines) {
    const std::string program = line.program < 0 ? "standing" : record.programNameOf(line.program);
    for (const PlotPoint& p : line.points) {
      csv.row(line.robot, number, program, line.free, p.t, p.x, p.y);
    }
    ++number;
  }
  return csv.text();
}

}  // namespace

FigureScript trajectoryByTime(const RunRecord& record) {
  FigureScript script = beginFigure("trajectory_time", "Trajectory, coloured by time");
  const PlotTracks plot = thinnedTracks(record, kPoints, false);
  if (nothingToDraw(plot)) {
    script.figure.sentence = "No trajectory: no robot has two tracked positions.";
    return script;
  }
  script.figure.csv = trackCsv(record, plot);
  const style::TimeAxis axis = style::timeAxis(plot.end - plot.begin);
  const double length = std::max(1e-6, plot.end - plot.begin);
  // A path changes colour in steps, so that each step is one element of the picture.
  const auto bin = [&](double t) {
    return std::clamp(static_cast<int>((t - plot.begin) / length * kColours), 0, kColours - 1);
  };
  std::vector<std::vector<PlotLine>> bins(kColours);
  for (const PlotLine& line : plot.lines) {
    int last = -1;
    for (const PlotPoint& point : line.points) {
      const int now = bin(point.t);
      auto& place = bins[static_cast<std::size_t>(now)];
      if (now != last) {
        if (last >= 0) bins[static_cast<std::size_t>(last)].back().points.push_back(point);
        place.push_back({line.robot, line.program, line.free, {}});
      }
      place.back().points.push_back(point);
      last = now;
    }
  }
  std::string plots;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i].empty()) continue;
    const double centre = plot.begin + length * (static_cast<double>(i) + 0.5) / kColours;
    DataBlock data(fmt::format("time{}", i));
    for (const PlotLine& line : bins[i]) addLine(data, line, 0);
    script.script += data.text();
    plots += fmt::format("{}$time{} with lines lw 1.5 lc palette cb {:.7g} notitle",
                         plots.empty() ? "" : ", \\\n  ", i, centre / axis.scale);
  }
  script.script += startsOf(plot) + style::preamble(script.figure.name, 900, 700, style::kPage_cm) +
                   arena(record);
  // Viridis (Smith and van der Walt 2015), ordered in lightness too, without its palest end.
  script.script += fmt::format(
      "set palette maxcolors {} defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', "
      "4 '#7ad151', 5 '#d8d020')\n"
      "set cbrange [{:.7g}:{:.7g}]\nset cblabel 'time ({})'\n"
      "plot {}, \\\n  $starts using 1:2 with points pt 6 ps 1.1 lw 2 lc rgb 'black' notitle\n",
      kColours, plot.begin / axis.scale, (plot.begin + length) / axis.scale, axis.unit, plots);
  script.figure.caption =
      whichPart(record, plot) + " Circles mark the beginning; the frame is the arena.";
  return script;
}

FigureScript trajectoryByProgram(const RunRecord& record) {
  FigureScript script = beginFigure("trajectory_program", "Trajectory, coloured by program");
  const PlotTracks plot = thinnedTracks(record, kPoints, true);
  if (nothingToDraw(plot)) {
    script.figure.sentence = "No trajectory: no robot has two tracked positions.";
    return script;
  }
  script.figure.csv = trackCsv(record, plot);
  std::string plots = "$held with lines lw 1 lc rgb '#BBBBBB' title 'cut'";
  DataBlock held("held");
  held.row(std::nan(""), std::nan(""));
  for (const PlotLine& line : plot.lines) {
    if (!line.free) addLine(held, line, 0);
  }
  script.script += held.text();
  for (std::size_t key = 0; key < record.programs.size(); ++key) {
    const int program = static_cast<int>(key);
    DataBlock data(fmt::format("program{}", key));
    bool any = false;
    for (const PlotLine& line : plot.lines) {
      if (!line.free || line.program != program) continue;
      addLine(data, line, 0);
      any = true;
    }
    if (!any) continue;
    script.script += data.text();
    plots += fmt::format(", \\\n  $program{} with lines lw 1.5 lc rgb '{}' title {}", key,
                         record.programs[key].colour, gnuplotText(record.programs[key].name));
  }
  script.script += startsOf(plot) + style::preamble(script.figure.name, 900, 700, style::kPage_cm) +
                   arena(record);
  plots += ", \\\n  $starts using 1:2 with points pt 6 ps 1.1 lw 2 lc rgb 'black' notitle";
  if (robotsOf(plot).size() <= kMostNumbers) {
    plots += ", \\\n  $starts using 1:2:3 with labels left offset 0.8,0.5 tc rgb 'black' notitle";
  }
  script.script += "set key outside top center horizontal samplen 1.6\nplot " + plots + "\n";
  script.figure.caption = fmt::format(
      "{} Circles mark where each robot begins; grey: the robot reversed, or its motion was cut "
      "for "
      "another reason.",
      plot.whole_run ? whichPart(record, plot)
                     : "The latest stretch of each program that remains legible.");
  return script;
}

}  // namespace lab::report
