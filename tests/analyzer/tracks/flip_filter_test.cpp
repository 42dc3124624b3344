#include "analyzer/tracks/flip_filter.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

constexpr double kPi = std::numbers::pi;

TrackPoint heading(double time, double theta) {
  TrackPoint point;
  point.time = time;
  point.theta = theta;
  return point;
}

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(FlipFilter, KeepsTheBitsOfUnflippedHeadings) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> turn(-0.3, 0.3);
  FlipFilter dut({});
  double theta = 3;
  for (int i = 0; i < 10000; ++i) {
    theta = std::remainder(theta + turn(random), 2 * kPi);
    TrackPoint point = heading(0.05 * i, theta);
    EXPECT_FALSE(dut.correct(point));
    ASSERT_TRUE(sameBits(point.theta, theta));
  }
  EXPECT_EQ(dut.jumps(), 0);
}

TEST(FlipFilter, CorrectsASingleFrameAndAStretch) {
  FlipFilter dut({});
  for (int i = 0; i < 200; ++i) {
    const double true_theta = 0.01 * i;
    const bool flipped = i == 20 || (i >= 50 && i < 150);
    TrackPoint point = heading(0.02 * i, true_theta + (flipped ? kPi : 0));
    EXPECT_EQ(dut.correct(point), flipped) << i;
    EXPECT_NEAR(std::remainder(point.theta - true_theta, 2 * kPi), 0, 1e-12);
  }
  EXPECT_EQ(dut.jumps(), 4);
  EXPECT_EQ(dut.chain(), 0);
}

TEST(FlipFilter, ToleratesASingleWrongHeading) {
  FlipFilter dut({});
  for (int i = 0; i < 100; ++i) {
    TrackPoint point = heading(0.02 * i, i % 10 == 5 ? 1.6 : i >= 50 ? kPi : 0);
    dut.correct(point);
    if (i % 10 == 5) continue;
    EXPECT_NEAR(std::remainder(point.theta, 2 * kPi), 0, 1e-12) << i;
  }
}

TEST(FlipFilter, AcceptsAJumpThatWheelsCouldHaveMade) {
  FlipFilter dut({});
  TrackPoint first = heading(0, 0);
  TrackPoint late = heading(0.5, kPi);  // 3.6 rad are within reach
  dut.correct(first);
  EXPECT_FALSE(dut.correct(late));
  EXPECT_EQ(late.theta, kPi);
  EXPECT_EQ(dut.chain(), 1);
}

TEST(FlipFilter, DeterminesTheHeadFromTheMotion) {
  FlipFilter dut({});
  const double enough = senseDistance(abpLaw(3, 0.5));
  TrackPoint point = heading(0, 1);
  dut.correct(point);
  EXPECT_FALSE(dut.addMotion(-0.9 * enough, enough));
  EXPECT_FALSE(dut.addMotion(-1, 0));  // a program that does not show its head
  EXPECT_TRUE(dut.addMotion(-0.2 * enough, enough));
  TrackPoint next = heading(0.02, 1);
  EXPECT_TRUE(dut.correct(next));
  EXPECT_NEAR(std::remainder(next.theta - 1 - kPi, 2 * kPi), 0, 1e-12);
}

TEST(SenseDistance, FollowsFromTheLikelihoodRatio) {
  // B = 0.1 s (0.1 m/s)^2 / 6, 20.7 B / (2 * 0.01 m/s)
  EXPECT_NEAR(senseDistance(noisyLaw(0.01, 0.1, 0.1)), 20.7 * 0.1 * 0.01 / 6 / 0.02, 1e-12);
  EXPECT_EQ(senseDistance(noisyLaw(0, 0.1, 0.1)), 0);
  EXPECT_GT(senseDistance(rtpLaw(1, 0.5)), 0);
  EXPECT_LT(senseDistance(abpLaw(3, 0.5, -0.03)), 0);
  EXPECT_EQ(senseDistance(ProgramLaw{}), 0);
}

/// Frames of a walker whose tracker confuses the ends: 1 % single frames, and every 40 s one
/// stretch of 5 s; the recording begins with the tail.
StitchedRecording stitchFlipped(const WalkerRecording& recording, bool flips) {
  StitchedRecording result;
  TrackStitcher stitcher{StitcherConfig{}};
  Walker walker(recording);
  std::mt19937_64 random(recording.seed + 77);
  std::bernoulli_distribution single(0.01);
  walker.on_frame = [&](TrackPoint point) {
    const bool stretch = std::fmod(point.time, 40) < 5;
    if (flips && (single(random) != stretch)) {
      point.theta = std::remainder(point.theta + kPi, 2 * kPi);
    }
    stitcher.addFrame(point, result.samples);
  };
  walker.on_telemetry = [&](RobotTelemetry telemetry) {
    telemetry.sense_distance = senseDistance(recording.law);
    stitcher.addTelemetry(telemetry, result.samples);
  };
  walker.run();
  stitcher.flush(result.samples);
  result.counters = stitcher.counters();
  result.tally = stitcher.tally(0);
  return result;
}

class FlippedRecording : public testing::TestWithParam<ProgramLaw> {};

TEST_P(FlippedRecording, HasTheTrueRotation) {
  constexpr int kRecordings = 16;
  EnsembleCurves curves;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording;
    recording.law = GetParam();
    recording.duration = 300;
    recording.fps = 24.3;
    recording.walls = true;
    recording.seed = 300U + static_cast<unsigned>(i);
    const StitchedRecording dut = stitchFlipped(recording, true);
    const StitchedRecording truth = stitchFlipped(recording, false);
    EXPECT_EQ(dut.tally.segments, truth.tally.segments);
    EXPECT_EQ(dut.samples.size(), truth.samples.size());
    EXPECT_GT(dut.counters.flips, 0.1 * static_cast<double>(dut.counters.frames));
    EXPECT_LE(dut.counters.sense_turns, 1);
    EXPECT_EQ(truth.counters.flips, 0);
    curves.add(analyseRecording(recording, dut, 20));
  }
  expectUnbiased(curves.msd, kRecordings, "MSD");
  expectUnbiased(curves.angular, kRecordings, "angular MSD");
}

TEST_P(FlippedRecording, DrivesForwardAfterTheHeadIsDetermined) {
  WalkerRecording recording;
  recording.law = GetParam();
  recording.duration = 120;
  const StitchedRecording dut = stitchFlipped(recording, true);
  const StitchedRecording truth = stitchFlipped(recording, false);
  ASSERT_EQ(dut.samples.size(), truth.samples.size());
  const double turned = dut.samples.back().theta - truth.samples.back().theta;
  if (senseDistance(recording.law) == 0) return;  // both ends are alike
  EXPECT_NEAR(std::remainder(turned, 2 * kPi), 0, 1e-9);
  EXPECT_EQ(dut.counters.sense_turns, 1);
}

INSTANTIATE_TEST_SUITE_P(Programs, FlippedRecording,
                         testing::Values(abpLaw(3, 0.5), noisyLaw(0.01, 0.1, 0.1),
                                         noisyLaw(0, 0.07, 0.2), rtpLaw(1, 0.5)));

}  // namespace
}  // namespace lab::analysis
