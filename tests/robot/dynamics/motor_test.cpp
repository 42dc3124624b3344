#include "robot/dynamics/motor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lab::dynamics {
namespace {

TEST(ClampWheel, LimitsBothDirectionsAndReportsSaturation) {
  bool saturated = false;
  EXPECT_EQ(clampWheel(270000, 270000, saturated), 270000);
  EXPECT_EQ(clampWheel(-270000, 270000, saturated), -270000);
  EXPECT_FALSE(saturated);
  EXPECT_EQ(clampWheel(-270001, 270000, saturated), -270000);
  EXPECT_TRUE(saturated);
  saturated = false;
  EXPECT_EQ(clampWheel(400000, 270000, saturated), 270000);
  EXPECT_TRUE(saturated);
}

TEST(DutyForSpeed, RoundsToNearestAndIsAnOddFunction) {
  for (int32_t um_s = 0; um_s <= 270000; um_s += 7) {
    const int16_t duty = dutyForSpeed(um_s, kMaxWheelUmS);
    ASSERT_EQ(duty, std::lround(um_s * 255.0 / 270000.0)) << um_s;
    ASSERT_EQ(dutyForSpeed(-um_s, kMaxWheelUmS), -duty) << um_s;
  }
  EXPECT_EQ(dutyForSpeed(30000, kMaxWheelUmS), 28);
  EXPECT_EQ(dutyForSpeed(300000, kMaxWheelUmS), 255);
}

/// The speed of a wheel with this calibration, um/s.
double turned(int16_t duty, int32_t max_um_s, const WheelCalibration& wheel) {
  const double size = std::abs(duty) <= wheel.dead_band ? 0 : std::abs(duty) - wheel.dead_band;
  const double speed = max_um_s * (wheel.gain_ppm * 1e-6) * size / (255 - wheel.dead_band);
  return duty < 0 ? -speed : speed;
}

TEST(CalibratedDuty, OfAnIdealWheelEqualsTheUncalibratedDuty) {
  for (int32_t um_s = -300000; um_s <= 300000; um_s += 11) {
    ASSERT_EQ(dutyForSpeed(um_s, kMaxWheelUmS, WheelCalibration{}),
              dutyForSpeed(um_s, kMaxWheelUmS))
        << um_s;
  }
}

TEST(CalibratedDuty, GivesTheSpeedNearestToTheCommand) {
  for (const WheelCalibration& wheel :
       {WheelCalibration{1000000, 0}, WheelCalibration{500000, 0}, WheelCalibration{1500000, 0},
        WheelCalibration{930000, 17}, WheelCalibration{1070000, 127}}) {
    const double fastest = turned(255, kMaxWheelUmS, wheel);
    const double step = fastest / (255 - wheel.dead_band);
    for (int32_t um_s = 0; um_s <= kMaxWheelUmS; um_s += 13) {
      const int16_t duty = dutyForSpeed(um_s, kMaxWheelUmS, wheel);
      ASSERT_EQ(dutyForSpeed(-um_s, kMaxWheelUmS, wheel), -duty) << um_s;
      ASSERT_LE(duty, 255);
      const double reachable = std::min<double>(um_s, fastest);
      ASSERT_NEAR(turned(duty, kMaxWheelUmS, wheel), reachable, step / 2 * 1.001 + 1) << um_s;
    }
  }
}

TEST(CalibratedDuty, IsZeroInsteadOfADutyInsideTheDeadBand) {
  const WheelCalibration wheel{1000000, 40};
  EXPECT_EQ(dutyForSpeed(0, kMaxWheelUmS, wheel), 0);
  EXPECT_EQ(dutyForSpeed(600, kMaxWheelUmS, wheel), 0);
  EXPECT_EQ(dutyForSpeed(700, kMaxWheelUmS, wheel), 41);
  EXPECT_EQ(dutyForSpeed(-700, kMaxWheelUmS, wheel), -41);
}

TEST(CalibratedDuty, IsCorrectAtTheExtremes) {
  constexpr int32_t kFastest = 5000000;
  EXPECT_EQ(dutyForSpeed(kFastest, kFastest, WheelCalibration{500000, 127}), 255);
  EXPECT_EQ(dutyForSpeed(-kFastest, kFastest, WheelCalibration{1500000, 0}), -170);
  EXPECT_EQ(dutyForSpeed(kFastest, kFastest, WheelCalibration{1500000, 0}), 170);
  EXPECT_EQ(dutyForSpeed(INT32_MAX, kMaxWheelUmS, WheelCalibration{}), 255);
  EXPECT_EQ(dutyForSpeed(1000, kMaxWheelUmS, WheelCalibration{0, 0}), 0)
      << "a wheel with gain 0 never turns";
}

}  // namespace
}  // namespace lab::dynamics
