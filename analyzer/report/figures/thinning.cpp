#include "analyzer/report/figures/thinning.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/math/units.hpp"

namespace lab::report {
namespace {

constexpr double kStep_m = 0.015;     // distance of points for smooth curves
constexpr double kLongestStep = 2.0;  // [s] between points
constexpr std::size_t kProbes = 400;  // number of samples of the speed

double periodOf(const Tracks& tracks) {
  const double span = units::seconds(tracks.frames.back().utime - tracks.frames.front().utime);
  return tracks.frames.size() > 1 && span > 0 ? span / static_cast<double>(tracks.frames.size() - 1)
                                              : 1.0;
}

/// Typical speed [m/s] over half a second, all robots.
double typicalSpeed(const Tracks& tracks, double period) {
  const auto half_second = static_cast<std::size_t>(std::max(1.0, std::round(0.5 / period)));
  const std::size_t stride = std::max<std::size_t>(1, tracks.frames.size() / kProbes);
  double distance = 0;
  double time = 0;
  for (std::size_t i = 0; i + half_second < tracks.frames.size(); i += stride) {
    const std::size_t j = i + half_second;
    tracks.rows.keepNear(tracks.frames[i].first_row);
    for (std::size_t a = tracks.frames[i].first_row; a < tracks.endOf(i); ++a) {
      for (std::size_t b = tracks.frames[j].first_row; b < tracks.endOf(j); ++b) {
        const TrackRow& from = tracks.rows[a];
        const TrackRow& to = tracks.rows[b];
        if (from.robot != to.robot) continue;
        distance += static_cast<double>(std::hypot(to.x - from.x, to.y - from.y));
        time += units::seconds(tracks.frames[j].utime - tracks.frames[i].utime);
      }
    }
  }
  tracks.rows.releaseMemory();
  return time > 0 ? distance / time : 0;
}

/// Collects points forward in time into lines.
class Lines {
 public:
  explicit Lines(double longest_gap) : longest_gap_(longest_gap) {}

  void add(const TrackRow& row, const PlotPoint& point) {
    const bool free = row.segment >= 0;
    const auto open = open_.find(row.robot);
    if (open != open_.end()) {
      PlotLine& line = lines_[open->second];
      const bool gap = point.t - line.points.back().t > longest_gap_;
      if (!gap && line.program == row.program && line.free == free) {
        line.points.push_back(point);
        return;
      }
      // The line ends where the next one begins: no gap between colours.
      if (!gap) line.points.push_back(point);
    }
    open_[row.robot] = lines_.size();
    lines_.push_back({row.robot, row.program, free, {point}});
  }

  std::vector<PlotLine> take() { return std::move(lines_); }

 private:
  double longest_gap_;
  std::map<int, std::size_t> open_;
  std::vector<PlotLine> lines_;
};

}  // namespace

PlotTracks thinnedTracks(const RunRecord& record, std::size_t points, bool per_program) {
  PlotTracks plot;
  const Tracks& tracks = record.tracks;
  if (tracks.rows.empty()) return plot;
  const double period = periodOf(tracks);
  const double speed = typicalSpeed(tracks, period);
  const double step = std::min(kLongestStep, speed > 0 ? kStep_m / speed : kLongestStep);
  // A short run is drawn with more points than necessary: as many as `points` allow. [frames]
  const double densest =
      std::ceil(static_cast<double>(tracks.rows.size()) / static_cast<double>(points));
  const auto stride =
      static_cast<std::size_t>(std::max(1.0, std::min(std::floor(step / period), densest)));

  // Backward in time until the points are used up. Each program has its share, unless all fit.
  const std::size_t programs = per_program ? std::max<std::size_t>(1, record.programs.size()) : 1;
  const bool all_fit = tracks.rows.size() / stride <= points;
  std::vector<std::size_t> left(programs, all_fit ? 2 * points : points / programs);
  std::vector<bool> chosen(tracks.rows.size(), false);
  for (std::size_t i = (tracks.frames.size() - 1) / stride * stride + stride; i >= stride;) {
    i -= stride;
    tracks.rows.keepNear(tracks.frames[i].first_row);
    for (std::size_t r = tracks.frames[i].first_row; r < tracks.endOf(i); ++r) {
      const int program = tracks.rows[r].program;
      const std::size_t share = per_program && program >= 0 ? static_cast<std::size_t>(program) : 0;
      if (left[share] == 0) {
        plot.whole_run = false;
        continue;
      }
      --left[share];
      chosen[r] = true;
    }
  }

  using units::kCm;
  Lines lines(std::max(1.0, 3 * static_cast<double>(stride) * period));
  bool first = true;
  for (std::size_t i = 0; i < tracks.frames.size(); i += stride) {
    tracks.rows.keepNear(tracks.frames[i].first_row);
    for (std::size_t r = tracks.frames[i].first_row; r < tracks.endOf(i); ++r) {
      if (!chosen[r]) continue;
      const TrackRow& row = tracks.rows[r];
      const double t = record.seconds(tracks.frames[i].utime);
      if (std::exchange(first, false)) plot.begin = t;
      plot.end = t;
      lines.add(row, {t, static_cast<double>(row.x) * kCm, static_cast<double>(row.y) * kCm});
    }
  }
  tracks.rows.releaseMemory();
  plot.lines = lines.take();
  return plot;
}

}  // namespace lab::report
