/// Poses that can be shown.
#pragma once

#include <cmath>
#include <lab/tracked_pose_t.hpp>

namespace lab::dashboard {

/// Numbers, of a place that an arena may have: nothing beyond becomes infinite in other units.
[[nodiscard]] inline bool isPlausiblePose(const tracked_pose_t& pose) {
  constexpr double kFarthest = 1e3;  // [m]
  return std::abs(pose.x) <= kFarthest && std::abs(pose.y) <= kFarthest &&
         std::isfinite(pose.theta);
}

}  // namespace lab::dashboard
