#include "analyzer/curves/join_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

/// Every join misplaces what follows by `defect` (m).
JoinComparison compared(const ProgramLaw& law, double defect, bool join = true) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = 1800;
  recording.fps = 9.97;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.0175;
  recording.walls = true;
  recording.seed = 11;
  StitcherConfig config;
  config.join = join;
  TrackStitcher stitcher(config);
  std::vector<Sample> samples;
  Walker walker(recording);
  walker.on_frame = [&](const TrackPoint& point) { stitcher.addFrame(point, samples); };
  walker.on_telemetry = [&](const RobotTelemetry& told) { stitcher.addTelemetry(told, samples); };
  walker.run();
  stitcher.flush(samples);
  JoinAccumulator watch(1 / recording.fps, 100);
  double offset = 0;
  Sample last;
  last.segment = -1;
  for (Sample sample : samples) {
    if (sample.segment == last.segment && sample.piece != last.piece) offset += defect;
    last = sample;
    sample.x += offset;
    watch.add(sample);
  }
  return compareJoins(watch.blocks());
}

class Joins : public testing::TestWithParam<ProgramLaw> {};

TEST_P(Joins, FitIfTheRobotResumesExactly) {
  const JoinComparison dut = compared(GetParam(), 0);
  EXPECT_GT(dut.joins, 5);
  EXPECT_GT(dut.compared, 4);
  EXPECT_LT(std::abs(dut.max_z), 4);
  for (const JoinLag& lag : dut.msd) EXPECT_EQ(lag.compared && lag.tau > dut.longest_lag, false);
}

TEST_P(Joins, DoNotFitIfTheyAreMisplaced) { EXPECT_GT(compared(GetParam(), 0.02).max_z, 4); }

INSTANTIATE_TEST_SUITE_P(Programs, Joins,
                         testing::Values(abpLaw(3, 0.5), abpLaw(1, 0.25), rtpLaw(1, 0.5)));

TEST(JoinComparison, ComparesNothingWithoutJoins) {
  const JoinComparison dut = compared(abpLaw(3, 0.5), 0, false);
  EXPECT_EQ(dut.joins, 0);
  EXPECT_EQ(dut.compared, 0);
  EXPECT_TRUE(std::isnan(dut.max_z));
}

}  // namespace
}  // namespace lab::analysis
