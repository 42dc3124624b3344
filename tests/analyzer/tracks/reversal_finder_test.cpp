// Reversals found in poses alone, compared with those of the walker.
#include "analyzer/tracks/reversal_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/tracks/pose_recording.hpp"

namespace lab::analysis::reversal_finder_test {
namespace {

struct Case {
  std::string name;
  ProgramLaw law;
  double fps;
};

WalkerRecording walled(const Case& one, double duration, unsigned seed) {
  WalkerRecording recording;
  recording.law = one.law;
  recording.fps = one.fps;
  recording.duration = duration;
  recording.sigma = 0.0005;
  recording.sigma_theta = 0.0175;
  recording.walls = true;
  recording.seed = seed;
  return recording;
}

class PosesAlone : public testing::TestWithParam<Case> {};

TEST_P(PosesAlone, ShowTheReversalsAndTheirTimes) {
  double truth = 0;
  double hits = 0;
  double wrong = 0;
  Scatter start;
  Scatter end;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const WalkerRecording recording = walled(GetParam(), 900, 7000 + seed);
    PoseRecording poses = posesOf(recording);
    const TrackFindings dut = examineTrack(poses.track, reversalSearch(recording.law, 0.1, 0.4));
    EXPECT_NEAR(dut.sigma, recording.sigma, 0.1 * recording.sigma);
    std::size_t next = 0;
    for (const FoundReversal& real : poses.truth) {
      // Shorter ones go a few millimetres, and the last one may outlast the recording.
      if (real.end < real.start + 0.5) continue;
      truth += 1;
      while (next < dut.reversals.size() && dut.reversals[next].end < real.start) {
        wrong += 1;
        ++next;
      }
      if (next == dut.reversals.size() || dut.reversals[next].start > real.end) continue;
      hits += 1;
      start.add(dut.reversals[next].start - real.start);
      end.add(dut.reversals[next].end - real.end);
      ++next;
    }
  }
  EXPECT_GE(truth, 1);
  EXPECT_GE(hits, 0.95 * truth);
  EXPECT_LE(wrong, 0.05 * truth + 1);  // short ones, as above
  const double frame = 1 / GetParam().fps;
  EXPECT_LT(std::abs(start.mean()), 0.5 * frame);
  EXPECT_LT(std::abs(end.mean()), 0.5 * frame);
}

TEST_P(PosesAlone, AreUnbiasedAfterStitching) {
  constexpr int kRecordings = 12;
  EnsembleCurves curves;
  for (unsigned i = 0; i < kRecordings; ++i) {
    const WalkerRecording recording = walled(GetParam(), 600, 8000 + i);
    const StitchedRecording stitched = stitchPoses(recording, posesOf(recording).track);
    EXPECT_EQ(stitched.counters.jumps, 0);
    curves.add(analyseRecording(recording, stitched));
  }
  expectUnbiasedWithNoise(walled(GetParam(), 600, 0), curves, kRecordings);
}

INSTANTIATE_TEST_SUITE_P(Programs, PosesAlone,
                         testing::Values(Case{"Abp10", abpLaw(3, 0.5), 9.97},
                                         Case{"Abp50", abpLaw(3, 0.5), 49.7},
                                         Case{"NoisyAbp10", noisyLaw(0.01, 0.1, 0.1), 9.97},
                                         Case{"NoisyAbp50", noisyLaw(0.01, 0.1, 0.1), 49.7},
                                         Case{"Bp10", noisyLaw(0, 0.07, 0.2), 9.97},
                                         Case{"Rtp10", rtpLaw(1, 0.5), 9.97},
                                         Case{"Rtp50", rtpLaw(1, 0.5), 49.7}),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(ReversalFinder, EstimatesTheSpeedFromTheTrack) {
  const WalkerRecording recording = walled({"", abpLaw(1, 0.25), 24.3}, 900, 5);
  PoseRecording poses = posesOf(recording);
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_NEAR(examineTrack(poses.track, reversalSearch(recording.law, nan, 0.4)).speed, 0.1, 0.002);
}

TEST(ReversalFinder, FindsNoneWithoutWalls) {
  for (const ProgramLaw& law : {abpLaw(3, 0.5), noisyLaw(0.01, 0.1, 0.1), noisyLaw(0, 0.1, 0.4),
                                noisyLaw(0, 0.07, 0.2), rtpLaw(1, 0.5)}) {
    for (const double fps : {9.97, 49.7}) {
      WalkerRecording recording = walled({"", law, fps}, 900, 9);
      recording.walls = false;
      PoseRecording poses = posesOf(recording);
      EXPECT_TRUE(examineTrack(poses.track, reversalSearch(law, 0.1, 0.4)).reversals.empty());
    }
  }
}

TEST(ReversalFinder, WorksWithFlippedHeadings) {
  const WalkerRecording recording = walled({"", abpLaw(3, 0.5), 24.3}, 900, 6);
  PoseRecording poses = posesOf(recording);
  const std::vector<TrackPoint> whole = poses.track;
  for (std::size_t i = 0; i < poses.track.size(); ++i) {
    if (i % 100 == 7 || poses.track[i].time < 300) {
      poses.track[i].theta =
          std::remainder(poses.track[i].theta + std::numbers::pi, 2 * std::numbers::pi);
    }
  }
  std::vector<TrackPoint> reference = whole;

  const ReversalSearch search = reversalSearch(recording.law, 0.1, 0.4);
  const TrackFindings expected = examineTrack(reference, search);
  const TrackFindings dut = examineTrack(poses.track, search);

  EXPECT_EQ(dut.reversals.size(), expected.reversals.size());
  EXPECT_GT(dut.flips, 0);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ASSERT_NEAR(std::remainder(poses.track[i].theta - whole[i].theta, 2 * std::numbers::pi), 0,
                1e-9)
        << i;
  }
}

TEST(ReversalFinder, WorksWithoutHeadings) {
  const WalkerRecording recording = walled({"", abpLaw(3, 0.5), 24.3}, 900, 8);
  PoseRecording poses = posesOf(recording);
  for (TrackPoint& point : poses.track) point.theta = 0;
  ReversalSearch search = reversalSearch(recording.law, 0.1, 0.4);
  search.headings = false;

  const TrackFindings dut = examineTrack(poses.track, search);

  const auto longer =
      std::count_if(poses.truth.begin(), poses.truth.end(),
                    [](const FoundReversal& one) { return one.end > one.start + 0.5; });
  EXPECT_GT(longer, 5);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(dut.reversals.size()), longer);
}

TEST(ReversalReporter, SetsTelemetryLikeARobot) {
  ReversalReporter dut({{.start = 1, .end = 5, .dx = -0.4}, {.start = 8, .end = 9, .dx = 0.1}});
  RobotTelemetry state;
  state.time = 0.5;
  dut.report(state);
  EXPECT_EQ(state.reversal_count, 0);
  state.time = 3;
  dut.report(state);
  EXPECT_EQ(state.reversal_count, 1);
  EXPECT_TRUE(state.reversing);
  EXPECT_DOUBLE_EQ(dut.removed(), 2);
  state.time = 8.5;
  dut.report(state);
  EXPECT_EQ(state.reversal_count, 2);
  EXPECT_DOUBLE_EQ(dut.removed(), 4.5);
  state.time = 20;
  dut.report(state);
  EXPECT_FALSE(state.reversing);
  EXPECT_DOUBLE_EQ(dut.removed(), 5);
  EXPECT_DOUBLE_EQ(state.reversal_end, 9);
}

}  // namespace
}  // namespace lab::analysis::reversal_finder_test
