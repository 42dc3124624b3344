/// Converts ROS 2's commands to the lab's.
#pragma once

#include "dds_gateway/ros/ros_type.hpp"

namespace lab::gateway {

struct WheelLimits {
  double max_speed = 0;   ///< [m/s] of each wheel
  double wheel_base = 0;  ///< [m]
};

struct WheelSpeeds {
  double left = 0;  ///< [m/s]
  double right = 0;
  bool clamped = false;

  bool operator==(const WheelSpeeds&) const = default;
};

/// Whether all six numbers are finite.
[[nodiscard]] bool isFinite(const ros::Twist& twist);

/// Wheel speeds of a finite twist: linear.x [m/s] forward and angular.z [rad/s]. The other
/// components are ignored, because a robot on two wheels cannot execute them. If a wheel would
/// exceed its limit, both speeds are scaled down, so that the path keeps its curvature.
[[nodiscard]] WheelSpeeds toWheels(const ros::Twist& twist, const WheelLimits& limits);

}  // namespace lab::gateway
