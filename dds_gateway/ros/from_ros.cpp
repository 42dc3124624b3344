#include "dds_gateway/ros/from_ros.hpp"

#include <algorithm>
#include <cmath>

namespace lab::gateway {
namespace {

bool isFinite(const ros::Vector3& vector) {
  return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

// Far above any wheel speed; its square is still finite.
constexpr double kFast = 1e9;

}  // namespace

bool isFinite(const ros::Twist& twist) { return isFinite(twist.linear) && isFinite(twist.angular); }

WheelSpeeds toWheels(const ros::Twist& twist, const WheelLimits& limits) {
  double forward = twist.linear.x;
  double rim = twist.angular.z * limits.wheel_base / 2;
  // The sum of two huge numbers is not finite.
  const double huge = std::max(std::abs(forward), std::abs(rim));
  if (huge > kFast) {
    forward *= kFast / huge;
    rim *= kFast / huge;
  }
  WheelSpeeds wheels{forward - rim, forward + rim, false};
  const double fastest = std::max(std::abs(wheels.left), std::abs(wheels.right));
  if (fastest > limits.max_speed) {
    const double share = limits.max_speed / fastest;
    wheels = {wheels.left * share, wheels.right * share, true};
  }
  return wheels;
}

}  // namespace lab::gateway
