// Reversals at walls, removed and joined, compared with the exact law of the infinite plane.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis::stitched_recording_test {
namespace {

WalkerRecording walled(const ProgramLaw& law, double duration) {
  WalkerRecording recording;
  recording.law = law;
  recording.duration = duration;
  recording.walls = true;
  return recording;
}

struct Case {
  std::string name;
  ProgramLaw law;
  double reversals_per_hour;  ///< At least.
};

class WalledRecording : public testing::TestWithParam<Case> {};

TEST_P(WalledRecording, FollowsTheExactLawOfTheFreeMotion) {
  constexpr int kRecordings = 24;
  EnsembleCurves curves;
  double reversals = 0;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording = walled(GetParam().law, 600);
    recording.seed = 100U + static_cast<unsigned>(i);
    const StitchedRecording stitched = stitch(recording);
    EXPECT_EQ(stitched.counters.lost_reversals, 0);
    EXPECT_EQ(stitched.counters.jumps, 0);
    EXPECT_EQ(stitched.tally.segments, 1);
    reversals += static_cast<double>(stitched.tally.reversals);
    curves.add(analyseRecording(recording, stitched));
  }
  EXPECT_GT(reversals / kRecordings * 6, GetParam().reversals_per_hour);
  expectUnbiased(curves.msd, kRecordings, "MSD");
  expectUnbiased(curves.angular, kRecordings, "angular MSD");
}

INSTANTIATE_TEST_SUITE_P(Programs, WalledRecording,
                         testing::Values(Case{"AbpFig2b", abpLaw(3, 0.5), 30},
                                         Case{"AbpEta1", abpLaw(1, 0.25), 100},
                                         Case{"NoisyAbp", noisyLaw(0.01, 0.1, 0.1), 20},
                                         Case{"Bp", noisyLaw(0, 0.07, 0.2), 1},
                                         Case{"Rtp", rtpLaw(1, 0.5), 30}),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(NaiveCutting, AtReversalsIsBiasedAgainstStraightMotion) {
  constexpr int kRecordings = 40;
  EnsembleCurves curves;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording = walled(abpLaw(1, 0.25), 600);
    recording.seed = 500U + static_cast<unsigned>(i);
    StitchedRecording stitched = stitch(recording);
    for (Sample& sample : stitched.samples) {
      sample.segment = sample.piece;  // a window may not cross a reversal
      sample.angular_segment = sample.piece;
    }
    curves.add(analyseRecording(recording, stitched));
  }
  double worst = 0;
  for (const LagScatter& lag : curves.msd) {
    if (lag.value.n == kRecordings) {
      worst = std::min(worst, lag.value.z(lag.exact));
    }
  }
  EXPECT_LT(worst, -4);
}

TEST(LostMessages, LeaveTheStitchedMotionUnbiased) {
  constexpr int kRecordings = 24;
  EnsembleCurves curves;
  double joined = 0;
  double cut = 0;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording = walled(abpLaw(1, 0.25), 600);
    recording.seed = 900U + static_cast<unsigned>(i);
    std::mt19937_64 random(recording.seed);
    std::bernoulli_distribution lost(0.1);
    StitchedRecording stitched;
    TrackStitcher stitcher{StitcherConfig{}};
    Walker walker(recording);
    walker.on_frame = [&](const TrackPoint& point) {
      if (!lost(random)) {
        stitcher.addFrame(point, stitched.samples);
      }
    };
    walker.on_telemetry = [&](const RobotTelemetry& telemetry) {
      if (!lost(random)) {
        stitcher.addTelemetry(telemetry, stitched.samples);
      }
    };
    walker.run();
    stitcher.flush(stitched.samples);
    stitched.tally = stitcher.tally(0);
    joined += static_cast<double>(stitcher.counters().reversals);
    cut += static_cast<double>(stitcher.counters().lost_reversals);
    curves.add(analyseRecording(recording, stitched));
  }
  EXPECT_GT(joined, 24 * 15);
  EXPECT_LT(cut, 0.01 * joined);
  expectUnbiased(curves.msd, kRecordings, "MSD");
  expectUnbiased(curves.angular, kRecordings, "angular MSD");
}

}  // namespace
}  // namespace lab::analysis::stitched_recording_test
