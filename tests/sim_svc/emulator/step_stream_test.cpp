#include "tests/sim_svc/emulator/step_stream.hpp"

#include <gtest/gtest.h>

namespace lab::emulator {
namespace {

// step_stream_long_test.cpp compares 10^5 draws of each program.
TEST(StepStream, ChipAndHostDrawTheSame) {
  for (unsigned slot = 0; slot < 4; ++slot) {
    expectEqualSteps(slot, 100 + slot, 10'000);
  }
}

TEST(StepStream, AnotherSeedGivesOtherDraws) {
  const auto a = stepsOfHost(0, 1, 10);
  const auto b = stepsOfHost(0, 2, 10);
  EXPECT_NE(a.at(0).rng, b.at(0).rng);
  EXPECT_NE(a.at(0).left_um_s, b.at(0).left_um_s);
}

}  // namespace
}  // namespace lab::emulator
