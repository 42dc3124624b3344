/// The noise of a tracker, and which segments of a pattern are good for a fit.
#pragma once

#include <cstddef>

#include "robot_bridge/calibration/motor_fit.hpp"

namespace lab::calibration {

/// A segment that can be used.
struct UsableSegment {
  std::size_t index = 0;  ///< among the segments driven
  double duty_left = 0;
  double duty_right = 0;
  SegmentMotion motion;
};

struct UsableSegments {
  std::vector<UsableSegment> segments;
  TrackNoise noise;      ///< estimated from the even segments
  SegmentCounts counts;  ///< driven, used, unseen, uneven
};

/// Fits the motion of each segment, estimates the tracker's noise from what is left over, and sorts
/// out what was not seen or not even.
[[nodiscard]] UsableSegments usableSegments(const std::vector<Segment>& segments);

}  // namespace lab::calibration
