// Simulated hours against the exact tables, through world, stitcher and accumulator. The other
// tables are in ensemble_long_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/system/laws/hour_ensemble.hpp"

namespace lab::system_test {
namespace {

/// The paper's formulas neglect epsilon: the same recordings must distinguish them from the exact
/// laws.
void expectPaperFails(const HourCurves& curves) {
  std::vector<double> paper;
  for (const int lag : curves.set.lags) {
    paper.push_back(curves.set.law->paperMsd(lag / curves.set.fps));
  }
  EXPECT_GT(std::abs(largestDeviation(curves.set, curves.msd, paper).z), 20);
}

class SimulatedHours : public testing::TestWithParam<const char*> {};

TEST_P(SimulatedHours, InTheArenaFollowTheExactLaw) {
  const HourRecordings recordings = {.table = GetParam()};
  const HourCurves dut = recordHours(recordings);
  expectExactLaw(recordings, dut);
  if (dut.set.law->held()) {
    expectPaperFails(dut);
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, SimulatedHours,
                         testing::Values("fig2b_ABP_v3_eps0.5_eta3", "fig3b_NABP_va1_V10_eps0.1",
                                         "fig3d_BP_V7_eps0.2", "fig4d_RTP_v5_gam1_tt0.5"),
                         [](const auto& parameter) { return testName(parameter.param); });

class RealHardwareHours : public testing::TestWithParam<const char*> {};

TEST_P(RealHardwareHours, InTheArenaFollowTheExactLawAtTheMeasuredSpeed) {
  const HourRecordings recordings = {.table = GetParam(), .hardware = Hardware::kReal};
  expectExactLaw(recordings, recordHours(recordings));
}

// The programs whose speed is changed by the quantisation of the wheel speeds.
INSTANTIATE_TEST_SUITE_P(Programs, RealHardwareHours,
                         testing::Values("fig2b_ABP_v3_eps0.5_eta3", "fig4d_RTP_v5_gam1_tt0.5"),
                         [](const auto& parameter) { return testName(parameter.param); });

}  // namespace
}  // namespace lab::system_test
