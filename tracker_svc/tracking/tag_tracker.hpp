/// Tracks tags: their numbers are their identities.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "tracker_svc/tracking/marker_tracker.hpp"

namespace lab::tracker {

/// The number of a track is that of its tag plus 1, because tracks are counted from 1. A tag with
/// the id of a robot is that robot.
class TagTracker final : public MarkerTracker {
 public:
  /// @param max_speed [m/s] for the places where tags are expected
  TagTracker(double max_speed, std::vector<std::int32_t> robot_ids);

  [[nodiscard]] const std::vector<detector::Expected>& expect(double time) override;
  const std::vector<Track>& update(double time,
                                   std::span<const detector::Detection> detections) override;
  [[nodiscard]] const TrackerCounts& counts() const override { return counts_; }

  /// [s] A tag without detection for this time is not expected any more.
  static constexpr double kGiveUp = 5;

 private:
  struct Known {
    Track track;
    double last = 0;  ///< [s] of its last detection
  };

  double max_speed_;
  std::vector<std::int32_t> robot_ids_;
  std::map<std::int32_t, Known> known_;
  std::vector<Track> tracks_;
  std::vector<detector::Expected> expected_;
  TrackerCounts counts_;
};

}  // namespace lab::tracker
