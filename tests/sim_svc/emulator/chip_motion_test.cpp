#include "tests/sim_svc/emulator/chip_motion.hpp"

#include <gtest/gtest.h>

namespace lab::emulator {
namespace {

// chip_motion_long_test.cpp compares 10^5 robot-seconds.
TEST(ChipMotion, EqualsTheCoreWithRandomPrograms) {
  const MotionTally tally = compareRandomMotion(3, 40);
  EXPECT_GT(tally.holds, 10'000U);
  EXPECT_GT(tally.interrupted, 100U);
  EXPECT_LT(tally.unsent, tally.holds / 10);
}

}  // namespace
}  // namespace lab::emulator
