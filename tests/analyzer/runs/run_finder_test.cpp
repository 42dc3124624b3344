// Runs and tumbles found in poses, against what an independent walker did.
#include "analyzer/runs/run_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analyzer/runs/run_statistics.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/runs/run_recording.hpp"

namespace lab::analysis {
namespace {

RunRecording recording(double gamma, double fps, double duration, std::uint64_t seed) {
  RunRecording recording;
  recording.law = rtpLaw(gamma, 0.5);
  recording.fps = fps;
  recording.duration = duration;
  recording.seed = seed;
  return recording;
}

double totalOf(const FoundRuns& found) {
  double total = 0;
  for (const ObservedRun& run : found.runs) total += run.duration;
  return total + static_cast<double>(found.hidden) * found.shortest / 2;
}

class FrameRates : public testing::TestWithParam<double> {};

TEST_P(FrameRates, EveryTumbleIsCountedAndAllRunTimeIsFound) {
  for (const double gamma : {1.0, 3.0}) {
    const RunRecording plan = recording(gamma, GetParam(), 1200, 5);
    TrueRuns truth;
    const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

    // The recording's ends are a tumble or two's uncertainty; a thousandth of them may be
    // misjudged.
    EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()),
                1 + 0.001 * static_cast<double>(truth.turns.size()));
    EXPECT_NEAR(totalOf(dut) / truth.run_time, 1, 0.003);
    EXPECT_NEAR(dut.speed.value, plan.law->meanSpeed(),
                4 * dut.speed.sigma + 0.0003 * plan.law->meanSpeed());
    EXPECT_NEAR(dut.tumble.value, plan.law->runs()->turn_time, 4 * dut.tumble.sigma);
    EXPECT_NEAR(dut.sigma, plan.sigma, 0.05 * plan.sigma);
  }
}

INSTANTIATE_TEST_SUITE_P(Fps, FrameRates, testing::Values(9.94, 24.9, 49.7, 99.4));

TEST(RunFinder, DetectsARunShorterThanAFrame) {
  // 0.5 s of standing, 60 ms of running, 0.5 s of standing: at 10 frames a second no frame may show
  // the motion.
  RunRecording plan = recording(3, 9.94, 300, 3);
  int drawn = 0;
  plan.run = [&drawn](std::mt19937_64&) { return ++drawn % 2 == 0 ? 0.09 : 1.0; };
  const FoundRuns dut = findRuns(plan, recordRuns(plan));

  const auto brief = std::count_if(dut.runs.begin(), dut.runs.end(),
                                   [](const ObservedRun& run) { return run.duration < 0.2; });
  EXPECT_NEAR(static_cast<double>(brief), 300 / 2.09, 6);
  for (const ObservedRun& run : dut.runs) {
    if (run.begun && run.ended) {
      EXPECT_LT(std::min(std::abs(run.duration - 0.09), std::abs(run.duration - 1)), 0.06);
    }
  }
}

TEST(RunFinder, CountsTwoTumblesInARowWithoutARun) {
  RunRecording plan = recording(3, 24.9, 300, 4);
  int drawn = 0;
  plan.run = [&drawn](std::mt19937_64&) { return ++drawn % 3 == 0 ? 0.001 : 0.5; };
  TrueRuns truth;
  const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

  EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 2);
  EXPECT_NEAR(static_cast<double>(dut.hidden), static_cast<double>(truth.turns.size()) / 3, 2);
}

TEST(RunFinder, DetectsATumbleWithoutTurn) {
  RunRecording plan = recording(3, 24.9, 300, 4);
  plan.turn = [](std::mt19937_64&) { return 0.0; };
  TrueRuns truth;
  const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

  EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 1);
}

TEST(RunFinder, MeasuresTheTurnOfEachTumble) {
  RunRecording plan = recording(1, 49.7, 300, 4);
  plan.turn = [](std::mt19937_64&) { return -2.0; };
  const FoundRuns dut = findRuns(plan, recordRuns(plan));

  int known = 0;
  for (const ObservedRun& run : dut.runs) {
    if (!std::isfinite(run.turn)) continue;
    ++known;
    EXPECT_NEAR(run.turn, -2, 0.15);
  }
  EXPECT_GT(known, 120);
}

TEST(RunFinder, UsesDirectionsOfMotionWithoutHeadings) {
  const RunRecording plan = recording(1, 49.7, 300, 4);
  TrueRuns truth;
  std::vector<Sample> samples = recordRuns(plan, &truth);
  for (Sample& sample : samples) sample.theta = std::nan("");
  const FoundRuns dut = findRuns(plan, samples);

  EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 1);
  EXPECT_GT(std::count_if(dut.runs.begin(), dut.runs.end(),
                          [](const ObservedRun& run) { return std::isfinite(run.turn); }),
            100);
}

TEST(RunFinder, MeasuresScalesThatDifferFromTheProgram) {
  RunRecording plan = recording(2, 24.9, 900, 6);
  plan.speed_factor = 0.9;
  plan.tumble_factor = 1.15;
  TrueRuns truth;
  const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

  EXPECT_NEAR(dut.speed.value, 0.9 * plan.law->meanSpeed(), 4 * dut.speed.sigma + 1e-5);
  EXPECT_NEAR(dut.tumble.value, 1.15 * plan.law->runs()->turn_time, 4 * dut.tumble.sigma);
  EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 3);
}

TEST(RunFinder, FindsTheRunsOfARobotThatCircles) {
  for (const double circling : {0.03, 0.1, -0.3}) {
    for (const double fps : {9.94, 49.7}) {
      RunRecording plan = recording(1, fps, 1800, 7);
      plan.circling = circling;
      TrueRuns truth;
      const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

      SCOPED_TRACE(testing::Message() << circling << " rad/s, " << fps << " frames/s");
      EXPECT_NEAR(dut.turning_rate.value, circling, 4 * dut.turning_rate.sigma);
      EXPECT_NEAR(dut.speed.value, plan.law->meanSpeed(),
                  4 * dut.speed.sigma + 0.0003 * plan.law->meanSpeed());
      EXPECT_NEAR(dut.tumble.value, plan.law->runs()->turn_time, 4 * dut.tumble.sigma);
      EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 2);
      EXPECT_NEAR(totalOf(dut) / truth.run_time, 1, 0.003);
    }
  }
}

TEST(RunFinder, ToleratesLostFrames) {
  RunRecording plan = recording(3, 24.9, 900, 7);
  plan.missing = 0.05;
  TrueRuns truth;
  const FoundRuns dut = findRuns(plan, recordRuns(plan, &truth));

  EXPECT_NEAR(static_cast<double>(dut.tumbles), static_cast<double>(truth.turns.size()), 3);
  EXPECT_NEAR(totalOf(dut) / truth.run_time, 1, 0.003);
}

TEST(RunFinder, CutsOffRunsAtTheEndsOfSegmentsAndAtGaps) {
  const RunRecording plan = recording(1, 24.9, 3600, 8);
  std::vector<Sample> samples = recordRuns(plan);
  for (Sample& sample : samples) {
    sample.segment = static_cast<int>(sample.time / 7.3);
  }
  std::erase_if(samples, [](const Sample& sample) { return std::fmod(sample.time, 31) < 1; });
  const FoundRuns dut = findRuns(plan, samples);
  const RunStatistics statistics = runStatistics(plan.law, {&dut});

  EXPECT_GT(dut.segments, 3600 / 7.3);
  EXPECT_GT(statistics.cut_off, 200);
  const Estimate& gamma = *statistics.find("gamma");
  EXPECT_LT(std::abs(gamma.value - 1), 4 * gamma.sigma);
  EXPECT_GT(statistics.exponential.p, 1e-3);
}

TEST(RunFinder, RejectsTooFewFramesPerTumble) {
  RunRecording plan = recording(1, 5, 60, 8);
  const FoundRuns dut = findRuns(plan, recordRuns(plan));

  EXPECT_FALSE(dut.resolved);
  EXPECT_EQ(runStatistics(plan.law, {&dut}).problem, "fewer than three frames in a tumble");
}

TEST(RunFinder, FindsNothingWithoutData) {
  const ProgramLaw law = rtpLaw(1, 0.5);
  for (const std::size_t frames : {0U, 1U, 2U, 30U}) {
    RunFinder finder(law, 0.04);
    Sample sample;
    for (std::size_t i = 0; i < frames; ++i) {
      sample.free_time = sample.time = 0.04 * static_cast<double>(i);
      finder.add(sample);
    }
    const FoundRuns dut = finder.find();
    EXPECT_TRUE(dut.runs.empty()) << frames;
    EXPECT_FALSE(runStatistics(law, {&dut}).problem.empty());
  }
}

}  // namespace
}  // namespace lab::analysis
