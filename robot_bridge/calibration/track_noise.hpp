/// Estimates the noise of a tracker and selects the segments of a pattern that a fit can use.
#pragma once

#include <cstddef>
#include <vector>

#include "robot_bridge/calibration/motor_fit.hpp"

namespace lab::calibration {

/// A segment that a fit can use.
struct UsableSegment {
  std::size_t index = 0;  ///< among the segments driven
  double duty_left = 0;
  double duty_right = 0;
  SegmentMotion motion;
};

struct UsableSegments {
  std::vector<UsableSegment> segments;
  TrackNoise noise;      ///< estimated from segments with uniform motion
  SegmentCounts counts;  ///< driven, used, unseen, uneven
};

/// Fits the motion of each segment, estimates the tracker's noise from the residuals, and excludes
/// segments that were not seen or not uniform.
[[nodiscard]] UsableSegments usableSegments(const std::vector<Segment>& segments);

}  // namespace lab::calibration
