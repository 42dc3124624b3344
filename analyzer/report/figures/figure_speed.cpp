#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using units::kCm;

constexpr double kStretch = 60;    // [s] shown of each program
constexpr double kBaseline = 0.2;  // [s] over which the speed is taken
constexpr std::size_t kMostPanels = 4;
constexpr std::size_t kMostRobotsWithSpeed = 8;  // with more, only one robot per program is drawn

struct Stretch {
  int robot = 0;
  std::int64_t begin_utime = 0;
  std::int64_t end_utime = 0;
};

/// The first minute of the longest uninterrupted time of any robot in the program.
std::optional<Stretch> stretchOf(const RunRecord& record, int program) {
  std::optional<Stretch> longest;
  for (const auto& [id, robot] : record.robots) {
    for (const ProgramSpan& span : robot.programs) {
      if (span.program != program) continue;
      if (!longest ||
          span.end_utime - span.begin_utime > longest->end_utime - longest->begin_utime) {
        longest = {id, span.begin_utime, span.end_utime};
      }
    }
  }
  if (longest) {
    longest->end_utime =
        std::min(longest->end_utime, longest->begin_utime + units::microseconds(kStretch));
  }
  return longest;
}

/// A step for at most five labels from 0 to `largest`: 1, 2 or 5 times a power of ten.
double ticStep(double largest) {
  constexpr double kMostSteps = 4;
  const double least = std::max(largest, 1e-6) / kMostSteps;
  const double decade = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least) return factor * decade;
  }
  return 10 * decade;
}

/// Adds the speed [cm/s] over the baseline, separately for free motion and the rest. @return
/// the largest speed; negative: there are no data.
double addSpeeds(const RunRecord& record, const Stretch& stretch, const std::string& name,
                 double spacing, DataBlock& free, DataBlock& held, CsvText& csv) {
  struct Place {
    std::int64_t utime;
    float x, y;  ///< [m]
    bool free;
  };
  std::vector<Place> places;
  const Tracks& tracks = record.tracks;
  for (std::size_t i = 0; i < tracks.frames.size(); ++i) {
    if (tracks.frames[i].utime < stretch.begin_utime) continue;
    if (tracks.frames[i].utime > stretch.end_utime) break;
    for (std::size_t r = tracks.frames[i].first_row; r < tracks.endOf(i); ++r) {
      const TrackRow& row = tracks.rows[r];
      if (row.robot == stretch.robot) {
        places.push_back({tracks.frames[i].utime, row.x, row.y, row.segment >= 0});
      }
      tracks.rows.keepNear(r);
    }
  }
  double largest = -1;
  bool last_free = true;
  std::size_t from = 0;
  double next = -1e300;
  for (const Place& to : places) {
    while (units::seconds(to.utime - places[from].utime) > kBaseline + 1e-4) ++from;
    const double dt = units::seconds(to.utime - places[from].utime);
    const double t = record.seconds(to.utime) - dt / 2;
    if (dt < kBaseline / 2 || t < next) continue;
    next = t + spacing;
    const double distance =
        static_cast<double>(std::hypot(to.x - places[from].x, to.y - places[from].y));
    const bool is_free = to.free && places[from].free;
    DataBlock& data = is_free ? free : held;
    if (is_free != last_free) (is_free ? free : held).blank();
    data.row(t, distance / dt * kCm);
    csv.row(name, stretch.robot, t, distance / dt * kCm, is_free);
    last_free = is_free;
    largest = std::max(largest, distance / dt * kCm);
  }
  return largest;
}

/// The speed of a program with constant speed [cm/s]; else negative.
double programmedSpeed(const RunRecord& record, const program_id_t& program) {
  const Program* known = findProgram(record.experimentOrDefault(), program);
  if (known == nullptr) return -1;
  const auto speed = analysis::lawOf(*known, analysis::kPaperWheelBase)->constantSpeed();
  return speed ? *speed * kCm : -1;
}

}  // namespace

FigureScript speedTraces(const RunRecord& record) {
  FigureScript script;
  script.figure.name = "speed";
  script.figure.title = "Speed";
  struct Panel {
    std::size_t key;
    Stretch stretch;
    double largest;  // cm/s
  };
  std::vector<Panel> panels;
  CsvText csv("program,particle,t_s,speed_cm_s,free");
  for (std::size_t key = 0; key < record.programs.size() && panels.size() < kMostPanels; ++key) {
    const std::optional<Stretch> stretch = stretchOf(record, static_cast<int>(key));
    if (!stretch) continue;
    DataBlock free(fmt::format("free{}", key));
    DataBlock held(fmt::format("held{}", key));
    DataBlock others(fmt::format("others{}", key));
    DataBlock unused("unused");
    for (DataBlock* block : {&free, &held, &others}) block->row(std::nan(""), std::nan(""));
    const std::string& name = record.programs[key].name;
    double largest = addSpeeds(record, *stretch, name, kBaseline / 4, free, held, csv);
    if (largest < 0) continue;
    for (const auto& [id, robot] : record.robots) {
      if (id == stretch->robot || record.robots.size() > kMostRobotsWithSpeed) continue;
      others.blank();
      const double other = addSpeeds(record, {id, stretch->begin_utime, stretch->end_utime}, name,
                                     kBaseline, others, unused, csv);
      largest = std::max(largest, other);
    }
    script.script += free.text() + held.text() + others.text();
    panels.push_back({key, *stretch, largest});
  }
  if (panels.empty()) {
    script.figure.sentence = "No speed trace: no robot was tracked while it ran a program.";
    return script;
  }
  script.figure.csv = csv.text();
  constexpr int kPanelHeight = 200;
  const int height = kPanelHeight * static_cast<int>(panels.size()) + 70;
  script.script += style::preamble(script.figure.name, 900, height, style::kPage_cm);
  script.script +=
      "set multiplot\nset lmargin at screen 0.10\nset rmargin at screen 0.97\n"
      "set ylabel 'speed (cm/s)' offset 0.5\nset yrange [0:*]\nset grid ytics lc rgb '#E4E4E4'\n"
      "unset key\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto& [key, stretch, largest] = panels[i];
    const int top = height - 32 - kPanelHeight * static_cast<int>(i);
    const double speed = programmedSpeed(record, record.programs[key].program);
    const std::string_view colour = record.programs[key].colour;
    script.script += fmt::format(
        "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n"
        "set xrange [{:.6g}:{:.6g}]\nset ytics {:.4g}\n{}"
        "set label 1 {} at graph 0,1.07 left tc rgb '{}' noenhanced\n"
        "plot $others{} using 1:2 with lines lw 0.7 lc rgb '#B8{}', "
        "$held{} using 1:2 with lines lw 1.2 lc rgb '#BBBBBB', "
        "$free{} using 1:2 with lines lw 1.4 lc rgb '{}'{}\n",
        static_cast<double>(top) / height, static_cast<double>(top - kPanelHeight + 68) / height,
        record.seconds(stretch.begin_utime), record.seconds(stretch.end_utime),
        ticStep(std::max(largest, speed)), i + 1 == panels.size() ? "set xlabel 'time (s)'\n" : "",
        gnuplotText(fmt::format("{}, robot {}", record.programs[key].name, stretch.robot)), colour,
        key, colour.substr(1), key, key, colour,
        speed > 0 ? fmt::format(", {:.5g} with lines lw 1 dt (6,4) lc rgb 'black'", speed) : "");
  }
  script.script += "unset multiplot\n";
  const bool all_robots = record.robots.size() > 1 && record.robots.size() <= kMostRobotsWithSpeed;
  script.figure.caption = fmt::format(
      "Displacement over {} s divided by the time, for up to {} s of each program{}; grey: "
      "reversing "
      "or cut; dashed: the programmed speed. Tracker noise increases the measured speed, turning "
      "decreases it.",
      shortText(kBaseline), shortText(kStretch), all_robots ? "; pale: the other robots" : "");
  return script;
}

}  // namespace lab::report
