#include <gtest/gtest.h>

#include "tests/sim_svc/emulator/step_stream.hpp"

namespace lab::emulator {
namespace {

class StepStreamLong : public testing::TestWithParam<unsigned> {};

TEST_P(StepStreamLong, ChipAndHostDrawTheSame) { expectEqualSteps(GetParam(), 7, 100'000); }

INSTANTIATE_TEST_SUITE_P(Programs, StepStreamLong, testing::Values(0U, 1U, 2U, 3U));

}  // namespace
}  // namespace lab::emulator
