#include "analyzer/report/poses/pose_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "analyzer/report_error.hpp"
#include "light/median.hpp"

namespace lab::report {
namespace {

constexpr std::int64_t kBadTimesOneIn = 20;
constexpr std::int64_t kContradictedOneIn = 20;
constexpr double kClockStep = 3;  // frames
constexpr double kDrift = 0.01;   // relative error of camera clocks, and jitter

class Collector {
 public:
  Collector(DiskVector<PoseRow> rows, const PoseNames& names, PoseFile& file)
      : rows_(std::move(rows)), names_(names), file_(file) {}

  void collect() {
    rows_.stableSort([](const PoseRow& a, const PoseRow& b) {
      return std::pair(a.frame, a.pose.robot) < std::pair(b.frame, b.pose.robot);
    });
    takeOutTwins();
    std::optional<PoseRow> bad;  // the first one whose time does not increase
    std::int64_t left_out = std::numeric_limits<std::int64_t>::min();
    rows_.each([&](const PoseRow& row) {
      if (row.frame == left_out) return;
      if (!file_.frames.empty() && file_.frames.back().frame == row.frame) {
        checkTimes(row);
        file_.poses.push_back(row.pose);
        return;
      }
      if (!file_.frames.empty() && !(row.time > file_.frames.back().time)) {
        if (!bad) bad = row;
        left_out = row.frame;
        ++file_.bad_times;
        return;
      }
      file_.add(row.time, row.frame, {&row.pose, 1});
    });
    const auto all = static_cast<std::int64_t>(file_.frames.size()) + file_.bad_times;
    if (bad && file_.bad_times * kBadTimesOneIn > all) {
      const std::string where =
          fmt::format("{}: found {} s in frame {}", names_.time, bad->time, bad->frame);
      fail(bad->line,
           fmt::format("{}, expected more than in the frames before it; so it is in {} of "
                       "{} frames. Without --fps nothing tells when they were taken: "
                       "leave the column of times out",
                       where, file_.bad_times, all));
    }
    measurePeriod();
  }

 private:
  [[noreturn]] void fail(std::int64_t line, const std::string& what) const {
    throw ReportError(fmt::format("{}:{}: {}", names_.file, line, what));
  }

  /// Rows of one frame must have equal times; it is unknown which one is wrong.
  void checkTimes(const PoseRow& row) const {
    if (row.time == file_.frames.back().time) return;
    fail(row.line, fmt::format("{}: found {} s, expected {} s as in the other rows of frame {}",
                               names_.time, row.time, file_.frames.back().time, row.frame));
  }

  /// Omits robots that appear twice in a frame. The rows are sorted by frame and robot.
  void takeOutTwins() {
    const auto sameRobot = [](const PoseRow& a, const PoseRow& b) {
      return a.frame == b.frame && a.pose.robot == b.pose.robot;
    };
    std::optional<PoseRow> first;  // the first row that contradicts another
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows_.size();) {
      std::size_t end = i + 1;
      std::optional<PoseRow> other;
      for (; end < rows_.size() && sameRobot(rows_[i], rows_[end]); ++end) {
        const Pose& a = rows_[i].pose;
        const Pose& b = rows_[end].pose;
        if (a.x != b.x || a.y != b.y || a.theta != b.theta || rows_[i].time != rows_[end].time) {
          other = rows_[end];
        }
      }
      if (!other) {
        file_.repeated += static_cast<std::int64_t>(end - i - 1);
        rows_[kept++] = rows_[i];
      } else {
        ++file_.contradicted;
        if (!first || other->line < first->line) first = other;
      }
      i = end;
      rows_.keepNear(i);
    }
    const auto all = static_cast<std::int64_t>(kept) + file_.contradicted;
    if (file_.contradicted * kContradictedOneIn > all) {
      fail(
          first->line,
          fmt::format("{}: found {} twice, and not alike, in frame {}, expected every robot once a "
                      "frame; so it is with {} of {} poses. Do two robots bear one number, or "
                      "frames of two recordings?",
                      names_.id, first->pose.robot, first->frame, file_.contradicted, all));
    }
    rows_.shrink(kept);
  }

  /// The period, the gaps in the frame numbers and the steps of the clock.
  void measurePeriod() {
    std::int64_t least_step = std::numeric_limits<std::int64_t>::max();
    std::vector<double> periods;
    for (std::size_t i = 1; i < file_.frames.size(); ++i) {
      least_step = std::min(least_step, file_.frames[i].frame - file_.frames[i - 1].frame);
      periods.push_back(file_.frames[i].time - file_.frames[i - 1].time);
    }
    if (periods.empty()) return;
    std::vector<double> sorted = periods;
    file_.frame_period = medianOf(sorted);
    constexpr double kShortest = 0.9e-6;  // the resolution of utime is a microsecond
    if (file_.frame_period < kShortest) {
      fail(1, fmt::format("{}: found {} s from frame to frame, expected 1e-6 s or more{}",
                          names_.time, file_.frame_period, names_.time_hint));
    }
    // A recording of which every n-th picture was tracked is complete.
    const std::int64_t span = file_.frames.back().frame - file_.frames.front().frame;
    file_.missing_frames =
        span / least_step + 1 - static_cast<std::int64_t>(file_.frames.size()) - file_.bad_times;
    for (std::size_t i = 0; i < periods.size(); ++i) {
      const std::int64_t frames = file_.frames[i + 1].frame - file_.frames[i].frame;
      const double expected = static_cast<double>(frames / least_step) * file_.frame_period;
      if (std::abs(periods[i] - expected) > kClockStep * file_.frame_period + kDrift * expected) {
        file_.clock_steps.push_back(file_.frames[i + 1].time);
      }
    }
  }

  DiskVector<PoseRow> rows_;
  const PoseNames& names_;
  PoseFile& file_;
};

}  // namespace

void collectFrames(DiskVector<PoseRow> rows, const PoseNames& names, PoseFile& file) {
  Collector(std::move(rows), names, file).collect();
}

}  // namespace lab::report
