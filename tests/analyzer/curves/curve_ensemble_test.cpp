// Ensembles that are large enough to detect small biases and wrong error bars.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis::recording_ensemble_test {
namespace {

struct Case {
  std::string name;
  ProgramLaw law;
  std::vector<std::string> estimates;
};

class RecordingEnsemble : public testing::TestWithParam<Case> {};

TEST_P(RecordingEnsemble, BetweenWallsFollowsTheExactLaw) {
  constexpr int kRecordings = 150;
  EnsembleCurves curves;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording;
    recording.law = GetParam().law;
    recording.duration = 1800;
    recording.walls = true;
    recording.seed = 20000U + static_cast<unsigned>(i);
    curves.add(analyseRecording(recording, stitch(recording)));
  }
  expectUnbiased(curves.msd, kRecordings, "MSD");
  expectUnbiased(curves.angular, kRecordings, "angular MSD");
}

TEST_P(RecordingEnsemble, HasTheStatedErrorsUpToA180thOfTheRecording) {
  WalkerRecording recording;
  recording.law = GetParam().law;
  recording.duration = 900;
  recording.fps = 24.3;
  recording.telemetry_rate = 20;
  const Coverage dut = cover(recording, 300, 5);
  expectTrueErrors(dut.curves.msd, recording.duration);
  expectTrueErrors(dut.curves.angular, recording.duration);
  EXPECT_LE(dut.disagreements, 3);  // 1 %
}

TEST_P(RecordingEnsemble, IntervalsOfShortRecordingsCoverTheTruthAtTheStatedRate) {
  const Coverage dut = cover(shortRecording(GetParam().law), 1000, 10);
  for (const std::string& name : GetParam().estimates) {
    expectCoverage(dut, name);
    const double deviation = dut.value.at(name).deviation();
    EXPECT_NEAR(dut.sigma.at(name).mean() / deviation, 1, 0.15) << name;
    // The ratio of random numbers has a bias of second order.
    EXPECT_NEAR(dut.value.at(name).mean(), dut.theory.at(name), 0.25 * deviation) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Programs, RecordingEnsemble,
    testing::Values(Case{"AbpFig2b", abpLaw(3, 0.5), {"D_r", "v", "D", "L_s"}},
                    Case{"AbpEta1", abpLaw(1, 0.25), {"D_r", "v", "D", "L_s"}},
                    Case{"NoisyAbp", noisyLaw(0.01, 0.1, 0.1), {"D_r", "v_a", "V", "D_t"}},
                    Case{"Bp", noisyLaw(0, 0.07, 0.2), {"D_r", "v", "V", "D_t", "D"}},
                    Case{"Rtp", rtpLaw(1, 0.5), {"v", "gamma", "tau_r", "D", "L_s"}}),
    [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace lab::analysis::recording_ensemble_test
