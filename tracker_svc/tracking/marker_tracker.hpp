/// What follows markers from picture to picture: the interface of the trackers of caps, blobs and
/// tags.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracker_svc/detection.hpp"

namespace lab::tracker {

/// Reported wheel speeds of a robot.
struct WheelReport {
  std::int32_t robot_id = 0;
  double time = 0;   ///< [s] sampling time, on the clock of the pictures
  double left = 0;   ///< [m/s]
  double right = 0;  ///< [m/s]
};

/// One tracked marker.
struct Track {
  std::int64_t number = 0;     ///< unique, never reused
  std::int32_t robot_id = -1;  ///< the robot it is bound to, -1 if unbound
  detector::Detection pose;    ///< of this picture, or predicted if not detected (quality 0)
  bool detected = false;       ///< in this picture
  double since_detection = 0;  ///< [s] since its last detection
  /// [1] probability that this detection is not the marker of the last one; only of blobs
  double swap = 0;
};

struct TrackerCounts {
  std::int64_t flips = 0;    ///< head/tail flips detected and corrected
  std::int64_t lost = 0;     ///< tracks given up
  std::int64_t bound = 0;    ///< bindings made
  std::int64_t unbound = 0;  ///< bindings ended because they became doubtful
};

class MarkerTracker {
 public:
  MarkerTracker() = default;
  MarkerTracker(const MarkerTracker&) = delete;
  MarkerTracker& operator=(const MarkerTracker&) = delete;
  virtual ~MarkerTracker() = default;

  /// Adds wheel reports; they may arrive up to a second after the picture they belong to.
  virtual void addReports(std::span<const WheelReport> /*wheels*/) {}

  /// Where to search the markers in a picture taken at `time` [s], one place per track in the order
  /// of the last update.
  [[nodiscard]] virtual const std::vector<detector::Expected>& expect(double time) = 0;

  /// Assigns the detections of the picture taken at `time` [s], which must increase. Detections of
  /// quality 0 are ignored.
  /// @return all tracks, valid until the next call
  virtual const std::vector<Track>& update(double time,
                                           std::span<const detector::Detection> detections) = 0;

  [[nodiscard]] virtual const TrackerCounts& counts() const = 0;
};

}  // namespace lab::tracker
