#include "robot/dynamics/odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/robot/dynamics/core_fixture.hpp"

namespace lab::dynamics {
namespace {

/// Heading and path from the wheel speeds, in floating point [rad, m].
struct Computed {
  double heading = 0;
  double distance = 0;

  void add(double left_um_s, double right_um_s, double seconds, double wheel_base) {
    heading += (right_um_s - left_um_s) * 1e-6 / wheel_base * seconds;
    distance += std::abs(left_um_s + right_um_s) * 1e-6 / 2 * seconds;
  }
};

/// Difference of two angles, in (-pi, pi].
double apart(double a, double b) { return std::remainder(a - b, 2 * std::numbers::pi); }

double radians(uint32_t turns) { return turns / 4294967296.0 * 2 * std::numbers::pi; }

TEST(Odometry, EqualsTheFloatingPointIntegralOverAnHour) {
  for (const int32_t half_um : {5000, 37500, 61234, 250000}) {
    std::mt19937 random(static_cast<unsigned>(half_um));
    std::uniform_int_distribution<int32_t> speed(-270000, 270000);
    std::uniform_int_distribution<uint32_t> duration(0, 3000);
    Odometry dut;
    dut.setHalfWheelBase(half_um);
    Computed expected;
    for (int i = 0; i < 3000; ++i) {
      const int32_t left = speed(random);
      const int32_t right = speed(random);
      const uint32_t ms = duration(random);
      dut.add(left, right, ms);
      expected.add(left, right, ms * 1e-3, half_um * 2e-6);
    }
    EXPECT_LT(std::abs(apart(radians(dut.headingTurns()), expected.heading)), 1e-6) << half_um;
    EXPECT_NEAR(dut.distanceUm() * 1e-6, expected.distance, 2e-6) << half_um;
  }
}

TEST(Odometry, DoesNotDependOnHowAMotionIsDivided) {
  Odometry whole;
  Odometry parts;
  whole.setHalfWheelBase(37500);
  parts.setHalfWheelBase(37500);
  whole.add(-12345, 67891, 10000);
  for (int i = 0; i < 10000; ++i) {
    parts.add(-12345, 67891, 1);
  }
  EXPECT_EQ(whole.headingTurns(), parts.headingTurns());
  EXPECT_EQ(whole.distanceUm(), parts.distanceUm());
}

TEST(Odometry, StaysAtItsEndsWhateverTheNumbers) {
  Odometry dut;
  dut.setHalfWheelBase(0);
  dut.add(INT32_MIN, INT32_MAX, 0xFFFFFFFFU);
  EXPECT_EQ(dut.headingTurns(), 0U);
  dut.add(270000, 270000, 0xFFFFFFFFU);
  dut.add(270000, 270000, 0xFFFFFFFFU);
  EXPECT_EQ(dut.distanceUm(), 549755813U);
}

// The core integrates what it commands, except reversals.
TEST(Odometry, OfARobotFollowsItsHoldsWithoutReversals) {
  CoreSettings settings = twoPrograms();
  settings.half_wheel_base_um = 40000;
  RobotCore dut = runningCore(0, settings);
  Computed expected;
  // The core counts at the beginning of each hold.
  for (uint32_t t = 0; t < 60000 || dut.holdStartMs() != t; ++t) {
    ASSERT_LT(t, 61000U);
    const WheelSpeedsUmS wheels = dut.wheels();
    if (!has(dut, kReversing)) {
      expected.add(wheels.left, wheels.right, 1e-3, 0.08);
    }
    dut.advanceTo(t + 1);
    if (t + 1 == 20130) {
      Sensors wall = light(100);
      wall.ir[0] = 500;
      dut.sense(t + 1, wall);
      ASSERT_TRUE(has(dut, kReversing));
    }
  }
  ASSERT_EQ(dut.report().reversal_count, 1U);
  EXPECT_LT(std::abs(apart(radians(dut.odometry().headingTurns()), expected.heading)), 1e-6);
  EXPECT_NEAR(dut.odometry().distanceUm() * 1e-6, expected.distance, 2e-6);
}

}  // namespace
}  // namespace lab::dynamics
