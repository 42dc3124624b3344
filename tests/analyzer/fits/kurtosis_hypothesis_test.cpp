#include "analyzer/fits/kurtosis_hypothesis.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

ProgramLaw bp(double amplitude, double epsilon, double wheel_base = kPaperWheelBase) {
  return noisyLaw(0, amplitude, epsilon, wheel_base);
}

KurtosisTest testRecording(const WalkerRecording& recording, const ProgramLaw& asked) {
  const StitchedRecording stitched = stitch(recording);
  ProgramAnalysis analysis(asked, 1 / recording.fps, 100);
  for (const Sample& sample : stitched.samples) analysis.add(sample);
  const auto test = testKurtosis(asked, analysis.data());
  return test.value_or(KurtosisTest{});
}

TEST(KurtosisTest, DetectsDiffusionAlongTheRobotAxisInOneHour) {
  WalkerRecording recording;
  recording.law = bp(0.07, 0.2);
  recording.duration = 3600;
  recording.fps = 10.3;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.01;
  const KurtosisTest test = testRecording(recording, recording.law);
  ASSERT_GE(test.lags.size(), 6U);
  EXPECT_TRUE(test.isotropic.rejected) << test.text;
  EXPECT_FALSE(test.exact.rejected) << test.text;
  EXPECT_EQ(test.text.rfind("Not Brownian motion in the plane: kurtosis 2.", 0), 0U) << test.text;
}

TEST(KurtosisTest, RejectsAnotherLaw) {
  // Robots that turn twenty times as fast are isotropic within a second: not the programmed law.
  WalkerRecording recording;
  recording.law = bp(0.07, 0.2, 0.075 / 6);
  recording.duration = 3600;
  recording.fps = 10.3;
  const KurtosisTest test = testRecording(recording, bp(0.07, 0.2));
  ASSERT_FALSE(test.lags.empty());
  EXPECT_TRUE(test.exact.rejected) << test.text;
}

TEST(KurtosisTest, NeedsABrownianParticleAndEnoughData) {
  WalkerRecording recording;
  recording.law = bp(0.07, 0.2);
  recording.duration = 2;
  recording.fps = 10.3;
  const StitchedRecording stitched = stitch(recording);
  ProgramAnalysis analysis(recording.law, 1 / recording.fps, 100);
  for (const Sample& sample : stitched.samples) analysis.add(sample);
  EXPECT_FALSE(testKurtosis(recording.law, analysis.data()));
  EXPECT_FALSE(testKurtosis(abpLaw(3, 0.5), analysis.data()));
  EXPECT_FALSE(testKurtosis(recording.law, BlockData{}));
}

TEST(KurtosisTest, RejectsTheTrueLawAtTheStatedRate) {
  int rejected = 0;
  constexpr int kRecordings = 100;
  Scatter largest;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording;
    recording.law = bp(0.07, 0.2);
    recording.duration = 1200;
    recording.fps = 10.3;
    recording.seed = static_cast<std::uint64_t>(100 + i);
    const KurtosisTest test = testRecording(recording, recording.law);
    rejected += test.exact.rejected ? 1 : 0;
    for (const KurtosisPoint& lag : test.lags) largest.add(std::abs(lag.z_exact));
  }
  RecordProperty("rejected", rejected);
  RecordProperty("mean_abs_z_percent", static_cast<int>(100 * largest.mean()));
  // One is expected; more than 4 have a chance of 4 in 1000 (the recordings are always the same).
  EXPECT_LE(rejected, 4);
}

}  // namespace
}  // namespace lab::analysis
