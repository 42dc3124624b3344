/// Checks poses before they are shown.
#pragma once

#include <cmath>
#include <lab/tracked_pose_t.hpp>

namespace lab::dashboard {

/// Whether a pose is finite and within 1 km, so that it stays finite in other units.
[[nodiscard]] inline bool isPlausiblePose(const tracked_pose_t& pose) {
  constexpr double kMaxDistance = 1e3;  // [m]
  return std::abs(pose.x) <= kMaxDistance && std::abs(pose.y) <= kMaxDistance &&
         std::isfinite(pose.theta);
}

}  // namespace lab::dashboard
