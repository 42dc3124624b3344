#include "robot_bridge/calibration/drive_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "robot/dynamics/kinematics.hpp"
#include "tests/robot_bridge/calibration/synthetic_motor_tracks.hpp"

namespace lab::calibration {
namespace {

constexpr double kDiameter = 0.075;

Surroundings emptyArena() { return {1.2, 0.9, {}, kDiameter}; }

dynamics::Pose after(const Pattern& pattern, const Motors& motors) {
  dynamics::Pose pose;
  for (const PatternStep& step : pattern) {
    const double left = wheelSpeed(motors.left, dutyFor({}, step.left, kMaxSpeed, true), kMaxSpeed);
    const double right =
        wheelSpeed(motors.right, dutyFor({}, step.right, kMaxSpeed, true), kMaxSpeed);
    pose = dynamics::apply(
        dynamics::makeArc(left, right, motors.wheel_base, step.duration + kSettleTime), pose);
  }
  return pose;
}

TEST(Pattern, OrdersWholeDutiesWhateverTheStoredCalibration) {
  for (const Motors& stored : {Motors{}, Motors{{0.93, 20.0 / 255}, {1.08, 31.0 / 255}, 0.07},
                               Motors{{1.2, 100.0 / 255}, {0.8, 0}, 0.08}}) {
    std::set<int> duties;
    for (const PatternStep& step : calibrationPattern(stored, kMaxSpeed)) {
      EXPECT_LE(std::fabs(step.left), kMaxSpeed * stored.left.gain);
      const double exact = dutyFor(stored.left, step.left, kMaxSpeed, false) * 255;
      const double whole = dutyFor(stored.left, step.left, kMaxSpeed, true) * 255;
      EXPECT_NEAR(exact, whole, 0.01);
      duties.insert(static_cast<int>(std::lround(std::fabs(whole))));
    }
    duties.erase(0);
    EXPECT_GE(duties.size(), 3U);
  }
}

TEST(Pattern, ReturnsAnyRobotToItsStart) {
  for (const Motors& motors :
       {Motors{}, Motors{{0.9, 0.08}, {1.1, 0.05}, 0.08}, Motors{{1.05, 0.3}, {1, 0}, 0.07}}) {
    for (const Pattern& pattern : {calibrationPattern({}, kMaxSpeed), checkPattern(kMaxSpeed)}) {
      const dynamics::Pose end = after(pattern, motors);
      EXPECT_LT(std::hypot(end.x, end.y), 1e-9);
      EXPECT_LT(std::fabs(end.theta), 1e-9);
    }
  }
}

TEST(Pattern, StaysNearItsStart) {
  EXPECT_LT(reachOf(calibrationPattern({}, kMaxSpeed), kDiameter), 0.15);
  EXPECT_LT(reachOf(checkPattern(kMaxSpeed), kDiameter), 0.15);
  EXPECT_GT(reachOf(checkPattern(kMaxSpeed), kDiameter), 0.05);
}

TEST(Pattern, TheCheckUsesSpeedsThatTheFitDidNot) {
  std::set<long> seen;
  for (const PatternStep& step : calibrationPattern({}, kMaxSpeed)) {
    seen.insert(std::lround(step.left * 1e4));
  }
  for (const PatternStep& step : checkPattern(kMaxSpeed)) {
    EXPECT_FALSE(seen.contains(std::lround(step.left * 1e4))) << step.left;
  }
}

TEST(ClearHeading, KeepsTheHeadingIfThereIsRoom) {
  const auto heading = clearHeading(checkPattern(kMaxSpeed), {0.6, 0.45, 1.2}, emptyArena());
  ASSERT_TRUE(heading);
  EXPECT_NEAR(*heading, 1.2, 1e-12);
}

TEST(ClearHeading, TurnsAwayFromAWall) {
  const auto heading = clearHeading(checkPattern(kMaxSpeed), {1.12, 0.45, 0}, emptyArena());
  ASSERT_TRUE(heading);
  EXPECT_GT(std::fabs(*heading), 1);
}

TEST(ClearHeading, FindsTheOnlyFreeDirectionAmongRobots) {
  Surroundings around = emptyArena();
  for (int degree = 90; degree <= 310; degree += 20) {
    const double angle = degree * M_PI / 180;
    around.others.push_back({0.6 + 0.18 * std::cos(angle), 0.45 + 0.18 * std::sin(angle), 0});
  }
  const auto heading = clearHeading(checkPattern(kMaxSpeed), {0.6, 0.45, M_PI}, around);
  ASSERT_TRUE(heading);
  EXPECT_LT(std::fabs(*heading - 20 * M_PI / 180), 0.9);
}

TEST(ClearHeading, IsInTheMiddleOfTheFreeDirections) {
  const Place robot{1.12, 0.45, 0};
  const double heading = clearHeading(checkPattern(kMaxSpeed), robot, emptyArena()).value();
  for (const double off : {-0.08, 0.08}) {
    const double nearby = heading + off;
    const auto again =
        clearHeading(checkPattern(kMaxSpeed), {robot.x, robot.y, nearby}, emptyArena());
    EXPECT_NEAR(again.value(), nearby, 1e-9);
  }
}

TEST(EscapePath, LeadsAwayFromANearWall) {
  const Place at_the_wall{0.41, 0.86, 2.0};
  EXPECT_FALSE(clearHeading(checkPattern(kMaxSpeed), at_the_wall, emptyArena()));
  const auto way = escapePath(checkPattern(kMaxSpeed), at_the_wall, emptyArena());
  ASSERT_TRUE(way);
  EXPECT_LT(std::sin(way->heading), -0.25);
  EXPECT_LE(way->distance, 0.08);
  const Place there{at_the_wall.x + way->distance * std::cos(way->heading),
                    at_the_wall.y + way->distance * std::sin(way->heading), way->heading};
  EXPECT_TRUE(clearHeading(checkPattern(kMaxSpeed), there, emptyArena()));
}

TEST(EscapePath, IsEmptyForAnEnclosedRobot) {
  Surroundings around = emptyArena();
  around.others = {{0.05 + 0.08, 0.05, 0}, {0.05, 0.05 + 0.08, 0}, {0.14, 0.14, 0}};
  EXPECT_FALSE(escapePath(checkPattern(kMaxSpeed), {0.05, 0.05, 0}, around));
}

TEST(ClearHeading, IsEmptyIfThereIsNone) {
  Surroundings around = emptyArena();
  around.others = {{0.69, 0.45, 0}, {0.51, 0.45, 0}, {0.6, 0.54, 0}, {0.6, 0.36, 0}};
  EXPECT_FALSE(clearHeading(calibrationPattern({}, kMaxSpeed), {0.6, 0.45, 0}, around));
}

}  // namespace
}  // namespace lab::calibration
