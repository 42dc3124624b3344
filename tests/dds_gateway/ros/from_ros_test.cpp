#include "dds_gateway/ros/from_ros.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lab::gateway {
namespace {

constexpr WheelLimits kLimits{0.27, 0.075};

ros::Twist twist(double forward, double turn) {
  ros::Twist message{};
  message.linear.x = forward;
  message.angular.z = turn;
  return message;
}

TEST(FromRos, WheelsFollowFromTheTwist) {
  EXPECT_EQ(toWheels(twist(0.1, 0), kLimits), (WheelSpeeds{0.1, 0.1, false}));
  // Counter-clockwise: the right wheel is the faster one.
  const WheelSpeeds left = toWheels(twist(0.1, 2), kLimits);
  EXPECT_DOUBLE_EQ(left.left, 0.1 - 0.075);
  EXPECT_DOUBLE_EQ(left.right, 0.1 + 0.075);
}

TEST(FromRos, ATwistThatIsTooFastKeepsItsCurvature) {
  for (const auto& [v, w] : {std::pair{2.0, 5.0},
                             {0.2, -8.0},
                             {-3.0, 0.5},
                             {0.0, 100.0},
                             {1e300, 1e300},
                             {-1e308, 1e308},
                             {1.7e308, 0.0}}) {
    const WheelSpeeds dut = toWheels(twist(v, w), kLimits);
    EXPECT_TRUE(dut.clamped);
    EXPECT_NEAR(std::max(std::abs(dut.left), std::abs(dut.right)), 0.27, 1e-15);
    const double forward = (dut.left + dut.right) / 2;
    const double turn = (dut.right - dut.left) / 0.075;
    const double scale = std::max(std::abs(v), std::abs(w));
    EXPECT_NEAR(forward * (w / scale), turn * (v / scale), 1e-13) << v << " " << w;
  }
}

TEST(FromRos, TheLimitItselfIsAllowed) {
  EXPECT_FALSE(toWheels(twist(0.27, 0), kLimits).clamped);
  EXPECT_TRUE(toWheels(twist(std::nextafter(0.27, 1), 0), kLimits).clamped);
}

TEST(FromRos, EveryNumberMustBeFinite) {
  EXPECT_TRUE(isFinite(twist(1, 1)));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 6; ++i) {
      ros::Twist message{};
      double* numbers[] = {&message.linear.x,  &message.linear.y,  &message.linear.z,
                           &message.angular.x, &message.angular.y, &message.angular.z};
      *numbers[i] = bad;
      EXPECT_FALSE(isFinite(message)) << i;
    }
  }
}

}  // namespace
}  // namespace lab::gateway
