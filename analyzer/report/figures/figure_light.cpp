#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "analyzer/report/figures/figure_files.hpp"
#include "analyzer/report/figures/figure_scripts.hpp"
#include "analyzer/report/figures/gnuplot.hpp"

namespace lab::report {
namespace {

constexpr std::size_t kMostStrips = 100;     // largest number of robots with strips
constexpr std::size_t kMostSpans = 3000;     // in all strips together
constexpr std::size_t kMostTics = 24;        // robots with labels
constexpr std::size_t kMostChanges = 1500;   // of the light that are drawn
constexpr std::size_t kMostReaders = 30;     // robots whose readings are drawn
constexpr std::size_t kMostReadings = 6000;  // of all of them

/// Darkest and brightest place over time, as steps.
DataBlock lightData(const RunRecord& record, const style::TimeAxis& axis) {
  DataBlock data("light");
  data.row(std::nan(""), std::nan(""), std::nan(""));
  const std::size_t stride = std::max<std::size_t>(1, record.light.size() / kMostChanges);
  const LightSpan* before = nullptr;
  for (std::size_t i = 0; i < record.light.size(); i += stride) {
    const LightSpan& span = record.light[i];
    const double t = record.seconds(span.begin_utime) / axis.scale;
    if (before != nullptr) data.row(t, before->low, before->high);
    data.row(t, span.low, span.high);
    before = &span;
  }
  if (before != nullptr) data.row(record.duration() / axis.scale, before->low, before->high);
  return data;
}

/// What the robots read of a light that depends on the place: front and back sensor together. One
/// line per robot. @return the plot elements.
std::string readings(const RunRecord& record, const style::TimeAxis& axis, std::string& data) {
  const bool is_uniform =
      std::ranges::all_of(record.light, [](const LightSpan& span) { return span.uniform; });
  if (is_uniform || record.robots.size() > kMostReaders) return {};
  const std::size_t frames = record.tracks.frames.size();
  const std::size_t most = kMostReadings / std::max<std::size_t>(1, record.robots.size());
  const std::size_t stride = std::max<std::size_t>(1, frames / std::max<std::size_t>(1, most));
  std::string plots;
  for (const auto& [id, robot] : record.robots) {
    DataBlock block(fmt::format("read{}", id));
    block.row(std::nan(""), std::nan(""));
    bool any = false;
    for (std::size_t i = 0; i < frames; i += stride) {
      record.tracks.rows.keepNear(record.tracks.frames[i].first_row);
      for (std::size_t r = record.tracks.frames[i].first_row; r < record.tracks.endOf(i); ++r) {
        const TrackRow& row = record.tracks.rows[r];
        const double light = 0.5 * static_cast<double>(row.light_front + row.light_back);
        if (row.robot != id || !std::isfinite(light)) continue;
        block.row(record.seconds(record.tracks.frames[i].utime) / axis.scale, light);
        any = true;
      }
    }
    if (!any) continue;
    data += block.text();
    plots += fmt::format(", \\\n  $read{} using 1:2 with lines lw 0.8 lc rgb '#404040'", id);
  }
  return plots;
}

/// The edges of the robots' light bands, with the program between them at the right.
std::string bands(const RunRecord& record) {
  std::string script;
  if (!record.experiment) return script;
  for (const LightBand& band : record.experiment->light_table.bands) {
    for (const double edge : {band.low, band.high}) {
      if (edge <= 0 || edge >= 1) continue;
      script += fmt::format(
          "set arrow from graph 0,first {0:.5g} to graph 1,first {0:.5g} nohead lw 0.8 dt (3,4) "
          "lc rgb '#909090'\n",
          edge);
    }
    script += fmt::format(
        "set label {} at graph 1.01,first {:.5g} left font small_font "
        "tc rgb '#404040' noenhanced\n",
        gnuplotText(band.program), (band.low + std::min(1.0, band.high)) / 2);
  }
  return script;
}

/// One strip per robot. @return the plot elements.
std::string strips(const RunRecord& record, const style::TimeAxis& axis, std::string& data) {
  std::string plots;
  for (std::size_t key = 0; key <= record.programs.size(); ++key) {
    const int program = key == record.programs.size() ? -1 : static_cast<int>(key);
    DataBlock block(fmt::format("strip{}", key));
    block.row(std::nan(""), std::nan(""), std::nan(""), std::nan(""), std::nan(""), std::nan(""));
    bool any = false;
    double row = 0;
    for (const auto& [id, robot] : record.robots) {
      ++row;
      for (const ProgramSpan& span : robot.programs) {
        if (span.program != program) continue;
        const double begin = record.seconds(span.begin_utime) / axis.scale;
        const double end = record.seconds(span.end_utime) / axis.scale;
        block.row((begin + end) / 2, row, begin, end, row - 0.4, row + 0.4);
        any = true;
      }
    }
    if (!any) continue;
    data += block.text();
    plots += fmt::format(
        "{}$strip{} using 1:2:3:4:5:6 with boxxyerror fs solid noborder lc rgb "
        "'{}' title {}",
        plots.empty() ? "" : ", \\\n  ", key,
        program < 0 ? style::kPaleGrey : std::string_view(record.programs[key].colour),
        program < 0 ? "'standing'" : gnuplotText(record.programs[key].name));
  }
  return plots;
}

/// The number of robots in each program. @return the plot elements.
std::string counts(const RunRecord& record, const style::TimeAxis& axis, std::string& data) {
  std::string plots;
  for (std::size_t key = 0; key < record.programs.size(); ++key) {
    std::map<std::int64_t, int> changes;
    for (const auto& [id, robot] : record.robots) {
      for (const ProgramSpan& span : robot.programs) {
        if (span.program != static_cast<int>(key)) continue;
        ++changes[span.begin_utime];
        --changes[span.end_utime];
      }
    }
    DataBlock block(fmt::format("count{}", key));
    block.row(0.0, 0.0);
    const std::size_t stride = std::max<std::size_t>(1, changes.size() / kMostChanges);
    int running = 0;
    std::size_t i = 0;
    for (const auto& [utime, change] : changes) {
      running += change;
      if (i++ % stride == 0) block.row(record.seconds(utime) / axis.scale, double(running));
    }
    data += block.text();
    plots += fmt::format("{}$count{} using 1:2 with steps lw 2 lc rgb '{}' title {}",
                         plots.empty() ? "" : ", \\\n  ", key, record.programs[key].colour,
                         gnuplotText(record.programs[key].name));
  }
  return plots;
}

/// Both parts of the figure: one row per span of the light, then per span of each robot's programs.
std::string lightCsv(const RunRecord& record) {
  CsvText csv("what,begin_s,end_s,darkest,brightest,particle,program");
  for (std::size_t i = 0; i < record.light.size(); ++i) {
    const LightSpan& span = record.light[i];
    const double end = i + 1 < record.light.size() ? record.seconds(record.light[i + 1].begin_utime)
                                                   : record.duration();
    csv.row("light", record.seconds(span.begin_utime), end, span.low, span.high, "", "");
  }
  for (const auto& [id, robot] : record.robots) {
    for (const ProgramSpan& span : robot.programs) {
      csv.row("program", record.seconds(span.begin_utime), record.seconds(span.end_utime), "", "",
              id, span.program < 0 ? "standing" : record.programNameOf(span.program));
    }
  }
  return csv.text();
}

std::string robotTics(const RunRecord& record) {
  const std::size_t every = (record.robots.size() + kMostTics - 1) / kMostTics;
  std::string tics;
  std::size_t row = 0;
  for (const auto& [id, robot] : record.robots) {
    if (row++ % every == 0) tics += fmt::format("{}'{}' {}", tics.empty() ? "" : ", ", id, row);
  }
  return tics;
}

bool fitsStrips(const RunRecord& record) {
  std::size_t spans = 0;
  for (const auto& [id, robot] : record.robots) spans += robot.programs.size();
  return record.robots.size() <= kMostStrips && spans <= kMostSpans;
}

}  // namespace

FigureScript lightAndPrograms(const RunRecord& record) {
  FigureScript script;
  script.figure.name = "light";
  script.figure.title = "Light and programs over time";
  if (record.light.empty() && record.robots.empty()) {
    script.figure.sentence = "Neither projector nor robots reported anything.";
    return script;
  }
  script.figure.csv = lightCsv(record);
  const double duration = std::max(record.duration(), 1e-3);
  const style::TimeAxis axis = style::timeAxis(duration);
  const bool as_strips = fitsStrips(record);
  script.script = lightData(record, axis).text();
  const std::string read = readings(record, axis, script.script);
  const std::string programs =
      as_strips ? strips(record, axis, script.script) : counts(record, axis, script.script);
  const int strip_height =
      as_strips ? std::clamp(static_cast<int>(record.robots.size()) * 20, 40, 340) : 260;
  const int height = 300 + strip_height;
  const auto screen = [height](int pixels_from_bottom) {
    return static_cast<double>(pixels_from_bottom) / height;
  };
  script.script += style::preamble(script.figure.name, 1200, height, style::kPage_cm);
  script.script += fmt::format(
      "set multiplot\nset lmargin at screen (on_paper ? 0.10 : 0.075)\nset rmargin at screen "
      "(on_paper ? 0.86 : 0.93)\n"
      "set xrange [0:{:.7g}]\nset yrange [-0.04:1.04]\nset ytics 0.25\n"
      "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n"
      "set format x ''\nset ylabel 'light' offset 0.5\nunset key\n",
      duration / axis.scale, screen(height - 14), screen(140 + strip_height));
  script.script += bands(record);
  script.script += fmt::format(
      "plot $light using 1:2:3 with filledcurves fs solid {} noborder lc rgb '#E69F00', "
      "$light using 1:2 with lines lw 2 lc rgb '#B87A00', "
      "$light using 1:3 with lines lw 2 lc rgb '#B87A00'{}\n"
      "unset label\nunset arrow\nset format x '%g'\n",
      read.empty() ? "0.35" : "0.15", read);
  script.script += fmt::format(
      "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\nset xlabel 'time ({})'\n"
      "set key at screen 0.48,screen {:.4f} center top horizontal\n",
      screen(80 + strip_height), screen(80), axis.unit, screen(124 + strip_height));
  if (programs.empty()) {
    script.script += "set yrange [0:1]\nunset ytics\nplot NaN notitle\n";
  } else if (as_strips) {
    script.script +=
        fmt::format("set ylabel 'robot' offset 0.5\nset yrange [{}:0.4]\nset ytics ({})\nplot {}\n",
                    static_cast<double>(record.robots.size()) + 0.6, robotTics(record), programs);
  } else {
    script.script += fmt::format(
        "set ylabel 'robots' offset 0.5\nset yrange [0:{:.4g}]\nset ytics auto\nplot {}\n",
        1.06 * static_cast<double>(record.robots.size()), programs);
  }
  script.script += "unset multiplot\n";
  script.figure.caption = fmt::format(
      "Above: the light (0 dark, 1 projector white), with its darkest and brightest place if it is "
      "not uniform{}. Dotted: the edges of the light bands. Below: the program that each robot "
      "reported.",
      read.empty() ? "" : "; thin lines: what each robot read, the mean of its two sensors");
  return script;
}

}  // namespace lab::report
