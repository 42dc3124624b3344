/// Every tracked pose of a run, frame by frame, with what the analysis made of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "analyzer/tracks/track_stitcher.hpp"
#include "common/files/disk_vector.hpp"
#include "common/math/units.hpp"

namespace lab::report {

/// One robot in one frame, as tracked.
struct TrackRow {
  std::int32_t robot = 0;
  float x = 0;                ///< [m]
  float y = 0;                ///< [m]
  float theta = 0;            ///< [rad]
  std::int16_t program = -1;  ///< key into RunRecord::programs; -1: none or unknown
  std::int32_t segment = -1;  ///< number of the piece of free motion; -1: not free
  /// Position with the reversals removed [m]; nan: not free.
  float stitched_x = static_cast<float>(units::kNan);
  float stitched_y = static_cast<float>(units::kNan);
  float light_front = static_cast<float>(units::kNan);  ///< sensor readings, 0 to 1; nan: unknown
  float light_back = static_cast<float>(units::kNan);
  analysis::FrameState state = analysis::FrameState::kLost;
  bool contact_robot = false;
  bool contact_wall = false;
};

struct TrackFrame {
  std::int64_t utime = 0;
  std::int64_t frame = 0;
  std::size_t first_row = 0;  ///< index into Tracks::rows
};

struct Tracks {
  std::vector<TrackFrame> frames;
  DiskVector<TrackRow> rows;

  /// Index behind the last row of frames[i].
  [[nodiscard]] std::size_t endOf(std::size_t i) const {
    return i + 1 < frames.size() ? frames[i + 1].first_row : rows.size();
  }

  /// Calls visit(frame, row) for all rows, in order.
  template <class Visit>
  void eachRow(Visit&& visit) {
    eachRowOf(*this, visit);
  }
  template <class Visit>
  void eachRow(Visit&& visit) const {
    eachRowOf(*this, visit);
  }

 private:
  template <class Self, class Visit>
  static void eachRowOf(Self& self, Visit& visit) {
    for (std::size_t i = 0; i < self.frames.size(); ++i) {
      for (std::size_t r = self.frames[i].first_row; r < self.endOf(i); ++r) {
        visit(self.frames[i], self.rows[r]);
        self.rows.keepNear(r);
      }
    }
    self.rows.releaseMemory();
  }
};

/// Collects tracks, and marks each row when the analysis has classified its frame, which is up to
/// half a second later.
class TrackCollector {
 public:
  void beginFrame(std::int64_t utime, std::int64_t frame) {
    tracks_.frames.push_back({utime, frame, tracks_.rows.size()});
  }

  /// @param time of the frame as in the analysis [s]
  void add(double time, const TrackRow& row) {
    robots_[row.robot].tracked.push_back({time, tracks_.rows.size()});
    tracks_.rows.push_back(row);
  }

  void classified(int robot, const analysis::FrameReport& frame) {
    Robot& places = robots_[robot];
    TrackRow* const row = take(places.tracked, frame.time);
    if (row == nullptr) return;
    row->state = frame.state;
    row->contact_robot = frame.contact_robot;
    row->contact_wall = frame.contact_wall;
    row->light_front = frame.light_front;
    row->light_back = frame.light_back;
    if (frame.state == analysis::FrameState::kFree) {
      places.free.push_back({frame.time, static_cast<std::size_t>(row - &tracks_.rows.front())});
    }
  }

  void sampled(int robot, const analysis::Sample& sample) {
    TrackRow* const row = take(robots_[robot].free, sample.time);
    if (row == nullptr) return;
    row->segment = sample.piece;
    row->stitched_x = static_cast<float>(sample.x);
    row->stitched_y = static_cast<float>(sample.y);
  }

  [[nodiscard]] bool knows(int robot) const { return robots_.contains(robot); }
  [[nodiscard]] std::size_t robots() const { return robots_.size(); }
  [[nodiscard]] const Tracks& tracks() const { return tracks_; }
  [[nodiscard]] Tracks takeTracks() { return std::move(tracks_); }

 private:
  struct Place {
    double time;
    std::size_t row;
  };
  struct Robot {
    std::deque<Place> tracked;  ///< Not classified yet.
    std::deque<Place> free;     ///< Classified as free, without their sample yet.
  };

  /// The row of that time; those before it are dropped. nullptr: there is none.
  TrackRow* take(std::deque<Place>& places, double time) {
    while (!places.empty() && places.front().time < time) places.pop_front();
    if (places.empty() || places.front().time != time) return nullptr;
    const std::size_t row = places.front().row;
    places.pop_front();
    return &tracks_.rows[row];
  }

  Tracks tracks_;
  std::map<std::int32_t, Robot> robots_;
};

}  // namespace lab::report
