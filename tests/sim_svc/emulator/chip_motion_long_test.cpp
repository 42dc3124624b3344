#include <gtest/gtest.h>

#include <iostream>
#include <string>

#include "common/programs/shipped_programs.hpp"
#include "tests/sim_svc/emulator/chip_motion.hpp"
#include "tests/sim_svc/emulator/chip_programs_of_any_bytes.hpp"

namespace lab::emulator {
namespace {

class ChipMotionLong : public testing::TestWithParam<unsigned> {};

TEST_P(ChipMotionLong, EqualsTheCoreWithRandomPrograms) { compareRandomMotion(GetParam(), 800); }

INSTANTIATE_TEST_SUITE_P(Seeds, ChipMotionLong, testing::Values(101U, 102U, 103U, 104U));

TEST(ChipMotionOfTheLibraryLong, EqualsTheCore) {
  MotionTally tally;
  for (const std::string& name : shippedProgramNames()) {
    compareMotion(::lab::shippedProgram(name, {}).code, 77, 600, tally);
    EXPECT_FALSE(testing::Test::HasFailure()) << name;
  }
  std::cout << tally.robot_seconds << " robot-seconds, " << tally.holds << " holds equal\n";
}

TEST(ChipProgramsLong, AnyBytesAreRefusedOrExecuted) { loadAnyBytes(5, 10'000); }

}  // namespace
}  // namespace lab::emulator
