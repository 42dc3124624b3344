#include "analyzer/curves/estimates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

TEST(Estimates, CoverTheTruthOfTheAbpAtTheStatedRate) {
  const Coverage dut = cover(shortRecording(abpLaw(3, 0.5)), 250, 10);
  for (const char* name : {"D_r", "v", "D", "L_s"}) {
    expectCoverage(dut, name);
  }
  EXPECT_LT(std::abs(dut.value.at("D_r").z(0.75)), 4);
  EXPECT_LT(std::abs(dut.value.at("v").z(0.03)), 4);
  EXPECT_EQ(dut.disagreements, 0);
}

TEST(Estimates, CoverTheTruthOfTheRtpAtTheStatedRate) {
  const Coverage dut = cover(shortRecording(rtpLaw(1, 0.5)), 200, 5);
  for (const char* name : {"v", "gamma", "tau_r", "D", "L_s"}) {
    expectCoverage(dut, name);
  }
}

// Steps across lost frames are chords of longer arcs, or part of a run and part of a turn.
TEST(Estimates, LostFramesDoNotBiasTheSpeed) {
  for (const ProgramLaw& law : {abpLaw(3, 0.5), rtpLaw(1, 0.5)}) {
    SCOPED_TRACE(law->name());
    WalkerRecording recording = shortRecording(law);
    recording.fps = 9.97;
    recording.missing = 0.1;
    const Coverage dut = cover(recording, 200, 10);
    EXPECT_LT(std::abs(dut.value.at("v").z(law->meanSpeed())), 4);
    EXPECT_LT(std::abs(dut.value.at("v").mean() / law->meanSpeed() - 1), 2e-4);
    expectCoverage(dut, "v");
  }
}

TEST(CurveErrors, EqualTheTrueScatterUpToA180thOfTheRecording) {
  WalkerRecording recording;
  recording.law = abpLaw(3, 0.5);
  recording.duration = 300;
  recording.fps = 24.3;
  recording.telemetry_rate = 20;
  const EnsembleCurves curves = cover(recording, 500, 1.67).curves;
  expectTrueErrors(curves.msd, recording.duration);
  expectTrueErrors(curves.angular, recording.duration);
}

TEST(Estimates, ReportInsufficientDataOfAFewSeconds) {
  WalkerRecording recording = shortRecording(abpLaw(3, 0.5));
  recording.duration = 3;
  const ProgramResult dut = analyseRecording(recording, stitch(recording));
  ASSERT_FALSE(dut.estimates.empty());
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kUndecided);
  for (const Estimate& estimate : dut.estimates) {
    if (estimate.name == "D_r") {
      EXPECT_NE(estimate.note.find("few blocks"), std::string::npos) << estimate.note;
      EXPECT_GT(estimate.sigma, 0.5 * estimate.value);
    }
    if (estimate.name == "D_slope") {
      EXPECT_TRUE(std::isnan(estimate.value));
      EXPECT_NE(estimate.note.find("too little data"), std::string::npos);
    }
  }
}

TEST(Estimates, AreAbsentWithoutDataOrLaw) {
  const ProgramAnalysis empty(abpLaw(3, 0.5), 0.02, 10);
  EXPECT_TRUE(estimate(abpLaw(3, 0.5), empty.data()).empty());
  EXPECT_TRUE(curves(abpLaw(3, 0.5), empty.data(), CurveOptions{}).msd.empty());
}

/// Ten minutes at 20 frames a second and 3 cm/s, with a heading that turns uniformly and randomly.
Estimate speedOfUnknown(double turn_rate, double rotational_diffusivity) {
  constexpr double kPeriod = 0.05;
  constexpr int kSteps = 50;  // a frame
  constexpr double kStep = kPeriod / kSteps;
  ProgramAnalysis analysis(ProgramLaw{}, kPeriod, 1);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Sample pose;
  for (int frame = 0; frame < 12'000; ++frame) {
    Sample seen = pose;
    seen.time = seen.free_time = kPeriod * frame;
    seen.theta += 0.01 * normal(random);
    analysis.add(seen);
    for (int i = 0; i < kSteps; ++i) {
      const double before = pose.theta;
      pose.theta +=
          turn_rate * kStep + std::sqrt(2 * rotational_diffusivity * kStep) * normal(random);
      const double between = 0.5 * (before + pose.theta);
      pose.x += 0.03 * kStep * std::cos(between);
      pose.y += 0.03 * kStep * std::sin(between);
    }
  }
  for (const Estimate& estimate :
       analyse(ProgramLaw{}, analysis.data(), ProgramTally{}, CurveOptions{}).estimates) {
    if (estimate.name == "v") return estimate;
  }
  return {};
}

TEST(Estimates, GiveTheSpeedForAnyTurningOfTheHeading) {
  for (const auto& [rate, diffusivity] :
       {std::pair{0.0, 2.0}, {4.0, 0.0}, {3.0, 0.5}, {0.0, 0.0}}) {
    SCOPED_TRACE(rate);
    SCOPED_TRACE(diffusivity);
    const Estimate dut = speedOfUnknown(rate, diffusivity);
    EXPECT_NEAR(dut.value, 0.03, 0.03 * 6e-4);
    EXPECT_LT(dut.low95, 0.03);
    EXPECT_GT(dut.high95, 0.03);
  }
}

TEST(Verdict, DisagreesWithANeighbouringProgram) {
  WalkerRecording recording = shortRecording(abpLaw(3, 0.5));
  recording.duration = 600;
  const StitchedRecording stitched = stitch(recording);
  EXPECT_EQ(analyseRecording(recording, stitched).verdict.kind, VerdictKind::kAgrees);

  recording.law = abpLaw(3.6, 0.5);  // D_r is 44 % larger
  EXPECT_EQ(analyseRecording(recording, stitched).verdict.kind, VerdictKind::kDisagrees);
  recording.law = abpLaw(3, 0.5, 0.035);  // more than a calibration error
  EXPECT_EQ(analyseRecording(recording, stitched).verdict.kind, VerdictKind::kDisagrees);
}

// Contacts leave few windows of long lags, in the few segments that are long enough.
TEST(Verdict, JudgesNoLagWithFewWindowsAfterCuts) {
  int disagree = 0;
  for (unsigned i = 0; i < 40; ++i) {
    WalkerRecording recording = shortRecording(abpLaw(3, 0.5));
    recording.duration = 1200;
    recording.cut_every = 3;
    recording.seed = 500 + i;
    const ProgramResult dut = analyseRecording(recording, stitch(recording));
    disagree += dut.verdict.kind == VerdictKind::kDisagrees ? 1 : 0;
    EXPECT_GE(dut.verdict.judged, 20);
    for (const CurvePoint& point : dut.curves.msd) {
      EXPECT_FALSE(point.judged && point.tau > 3 * 3.3) << point.tau;  // e^-3.3 of the windows
    }
  }
  EXPECT_LE(disagree, 2);  // above 4 sigma by chance in one of a thousand recordings
}

TEST(Verdict, AcceptsASmallSpeedErrorAsCalibration) {
  WalkerRecording recording = shortRecording(abpLaw(3, 0.5, 0.0297));
  recording.duration = 600;
  const StitchedRecording stitched = stitch(recording);
  recording.law = abpLaw(3, 0.5, 0.03);
  const ProgramResult dut = analyseRecording(recording, stitched);
  EXPECT_EQ(dut.verdict.kind, VerdictKind::kAgrees);
  for (const Estimate& estimate : dut.estimates) {
    if (estimate.name == "v") {
      EXPECT_LT(estimate.high95, 0.03);  // but the estimate shows it
    }
  }
}

TEST(Curves, SeparateTheTrackerNoise) {
  WalkerRecording recording = shortRecording(abpLaw(3, 0.5));
  recording.duration = 600;
  const ProgramResult dut = analyseRecording(recording, stitch(recording));
  const double sigma2 = recording.sigma * recording.sigma;
  const double sigma_theta2 = recording.sigma_theta * recording.sigma_theta;
  EXPECT_NEAR(dut.curves.msd.front().noise / (4 * sigma2), 1, 0.03);
  EXPECT_NEAR(dut.curves.angular_msd.front().noise / (2 * sigma_theta2), 1, 0.03);
  EXPECT_LT(std::abs(dut.curves.msd.front().z), 4);
}

}  // namespace
}  // namespace lab::analysis
