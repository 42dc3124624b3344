#include "robot/dynamics/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::dynamics {
namespace {

constexpr double kBase = 0.075;
constexpr double kPi = 3.14159265358979323846;

TEST(Arc, FasterRightWheelTurnsCounterClockwise) {
  const Pose pose = apply(makeArc(0.02, 0.04, kBase, 0.5), Pose{0, 0, 0});
  EXPECT_GT(pose.theta, 0);
  EXPECT_GT(pose.y, 0);
  EXPECT_DOUBLE_EQ(pose.theta, 0.02 / kBase * 0.5);
}

TEST(Arc, IsStraightWithoutATurn) {
  const Pose pose = apply(makeArc(0.1, 0.1, kBase, 2), Pose{1, 2, kPi / 6});
  EXPECT_NEAR(pose.x, 1 + 0.2 * std::cos(kPi / 6), 1e-15);
  EXPECT_NEAR(pose.y, 2 + 0.1, 1e-15);
  EXPECT_EQ(pose.theta, kPi / 6);
}

TEST(Arc, OppositeWheelsTurnOnTheSpot) {
  const double wheel = kPi * kBase / 2 / 0.5;
  const Pose pose = apply(makeArc(-wheel, wheel, kBase, 0.5), Pose{0.3, 0.4, 1});
  EXPECT_DOUBLE_EQ(pose.x, 0.3);
  EXPECT_DOUBLE_EQ(pose.y, 0.4);
  EXPECT_DOUBLE_EQ(pose.theta, 1 + kPi);
}

TEST(Arc, AFullCircleReturnsToItsStart) {
  // Radius 10 cm, one circle in 8 s.
  const double v = 2 * kPi * 0.1 / 8;
  const double w = 2 * kPi / 8;
  const Arc arc = makeArc(v - w * kBase / 2, v + w * kBase / 2, kBase, 0.01);
  Pose pose{0.5, 0.5, 0.7};
  for (int i = 0; i < 800; ++i) {
    pose = apply(arc, pose);
  }
  EXPECT_NEAR(pose.x, 0.5, 1e-13);
  EXPECT_NEAR(pose.y, 0.5, 1e-13);
  EXPECT_NEAR(pose.theta, 0.7 + 2 * kPi, 1e-12);
}

TEST(Arc, SplittingItChangesNothing) {
  const Pose start{0.1, 0.2, 0.3};
  for (const double right : {0.03, 0.030000001, 0.0300001, 0.031, 0.2, -0.2}) {
    const Pose whole = apply(makeArc(0.03, right, kBase, 0.5), start);
    const Pose parts =
        apply(makeArc(0.03, right, kBase, 0.3), apply(makeArc(0.03, right, kBase, 0.2), start));
    EXPECT_NEAR(whole.x, parts.x, 1e-16 + 2e-16) << right;
    EXPECT_NEAR(whole.y, parts.y, 1e-16 + 2e-16) << right;
    EXPECT_NEAR(whole.theta, parts.theta, 1e-15) << right;
  }
}

TEST(Arc, IsExactAcrossTheSmallAngleLimit) {
  // dy = v (1 - cos phi) / w with phi = w dt, computed in long double on both sides of the limit
  // below which the series is used.
  for (const double phi : {1e-9, 1e-6, 1e-4, 1e-2, 0.199, 0.201, 1.0}) {
    const double w = phi / 0.01;
    const Arc arc = makeArcOf(0.03, w, 0.01);
    const long double turn = phi;
    const long double half = std::sin(turn / 2);
    const long double dy = 0.03L * 0.01L / turn * 2 * half * half;
    EXPECT_NEAR(arc.dy / static_cast<double>(dy), 1, 1e-14) << phi;
    const long double dx = 0.03L * 0.01L / turn * std::sin(turn);
    EXPECT_NEAR(arc.dx / static_cast<double>(dx), 1, 1e-14) << phi;
    EXPECT_NEAR(arc.cos_turn, std::cos(phi), 3e-16) << phi;
    EXPECT_NEAR(arc.sin_turn, std::sin(phi), 3e-16) << phi;
  }
}

TEST(WheelSpeed, IsQuantisedToTheNearestDuty) {
  const WheelModel wheel;
  EXPECT_NEAR(wheelSpeed(30000, wheel), 0.0296471, 1e-7);
  EXPECT_NEAR(wheelSpeed(-50000, wheel), -0.0497647, 1e-7);
  EXPECT_DOUBLE_EQ(wheelSpeed(300000, wheel), 0.27);
  EXPECT_EQ(wheelSpeed(0, wheel), 0);
}

TEST(WheelSpeed, OfAnIdealWheelIsTheCommandTimesTheGain) {
  WheelModel wheel;
  wheel.ideal = true;
  EXPECT_DOUBLE_EQ(wheelSpeed(30001, wheel), 0.030001);
  wheel.gain = 1.05;
  EXPECT_DOUBLE_EQ(wheelSpeed(-30000, wheel), -0.0315);
}

}  // namespace
}  // namespace lab::dynamics
