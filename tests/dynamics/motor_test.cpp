#include "dynamics/motor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::dynamics {
namespace {

TEST(ClampWheel, LimitsBothWaysAndSaysSo) {
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

TEST(DutyForSpeed, RoundsToNearestAndIsOdd) {
  for (int32_t um_s = 0; um_s <= 270000; um_s += 7) {
    const int16_t duty = dutyForSpeed(um_s, kMaxWheelUmS);
    ASSERT_EQ(duty, std::lround(um_s * 255.0 / 270000.0)) << um_s;
    ASSERT_EQ(dutyForSpeed(-um_s, kMaxWheelUmS), -duty) << um_s;
  }
  EXPECT_EQ(dutyForSpeed(30000, kMaxWheelUmS), 28);
  EXPECT_EQ(dutyForSpeed(300000, kMaxWheelUmS), 255);
}

}  // namespace
}  // namespace lab::dynamics
