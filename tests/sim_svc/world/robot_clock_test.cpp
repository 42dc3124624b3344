#include "sim_svc/world/robot_clock.hpp"

#include <gtest/gtest.h>

namespace lab::sim {
namespace {

TEST(RobotClock, ConvertsTimesInBothDirections) {
  const RobotClock dut(1234.5, 1.005);
  EXPECT_EQ(dut.localMs(0), 1234);
  EXPECT_EQ(dut.localMs(100), 1234 + 100500);
  EXPECT_NEAR(dut.worldTime(dut.localMs(100)), 100, 1e-3);
  EXPECT_DOUBLE_EQ(dut.worldTime(2239), 1004.5 / 1005);
}

TEST(RobotClock, AFastClockIsEarly) {
  const RobotClock fast(0, 1.01);
  EXPECT_LT(fast.worldTime(1000), 1);
}

TEST(UnwrapMs, FindsTheNearestTimeAcrossTheWrap) {
  const std::int64_t near = (std::int64_t{1} << 32) + 5;
  EXPECT_EQ(unwrapMs(5, near), near);
  EXPECT_EQ(unwrapMs(25, near), near + 20);
  EXPECT_EQ(unwrapMs(0xFFFFFFFFU, near), near - 6);
  EXPECT_EQ(unwrapMs(0xFFFFFFFFU, 10), -1);
}

}  // namespace
}  // namespace lab::sim
