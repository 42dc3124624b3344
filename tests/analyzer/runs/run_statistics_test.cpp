// Statistics of runs: estimates with calibrated errors, and the power to reject wrong programs.
#include "analyzer/runs/run_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"
#include "tests/analyzer/runs/run_recording.hpp"

namespace lab::analysis {
namespace {

RunStatistics statisticsOf(const RunRecording& recording) {
  const FoundRuns found = findRuns(recording, recordRuns(recording));
  return runStatistics(recording.law, {&found});
}

RunRecording twoMinutes(std::uint64_t seed) {
  RunRecording recording;
  recording.law = rtpLaw(3, 0.5);
  recording.fps = 24.9;
  recording.duration = 120;
  recording.seed = seed;
  return recording;
}

TEST(RunStatistics, IntervalsCoverTheTruthInShortRecordings) {
  constexpr int kRecordings = 100;
  std::map<std::string, int> covered;
  int rejected = 0;
  Scatter gamma;
  for (int i = 0; i < kRecordings; ++i) {
    const RunStatistics dut = statisticsOf(twoMinutes(100U + static_cast<unsigned>(i)));
    ASSERT_TRUE(dut.problem.empty());
    for (const Estimate& one : dut.estimates) {
      covered[one.name] += one.low95 <= one.theory && one.theory <= one.high95 ? 1 : 0;
    }
    rejected += dut.exponential.p < 0.05 || dut.uniform.p < 0.05 ? 1 : 0;
    gamma.add(dut.find("gamma")->value);
  }
  // 4 binomial standard errors of 95 %.
  for (const auto& [name, count] : covered) EXPECT_GT(count, 0.862 * kRecordings) << name;
  EXPECT_LT(rejected, 0.22 * kRecordings);
  EXPECT_LT(std::abs(gamma.z(3)), 4);
}

TEST(RunStatistics, HistogramsFollowTheLaw) {
  RunRecording recording = twoMinutes(3);
  recording.duration = 3600;
  const RunStatistics dut = statisticsOf(recording);

  double largest = 0;
  for (const DensityBar& bar : dut.run_times) {
    if (bar.count >= 20)
      largest = std::max(largest, std::abs(bar.density - bar.theory) / bar.sigma);
  }
  EXPECT_LT(largest, 4);
  EXPECT_GT(dut.run_times.size(), 15U);
  double sum = 0;
  for (const DensityBar& bar : dut.turns) sum += bar.density * (bar.high - bar.low);
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(dut.turns.size(), 36U);
  EXPECT_NEAR(dut.wheel_speed, 0.99 * dut.needed_wheel_speed, 0.02 * dut.needed_wheel_speed);
}

// A simulated camera has no noise unless it is given one; then the errors of a robot are 0.
TEST(RunStatistics, NeedsNoNoise) {
  std::vector<FoundRuns> found;
  for (unsigned i = 0; i < 4; ++i) {
    RunRecording recording = twoMinutes(60 + i);
    recording.duration = 600;
    recording.sigma = recording.sigma_theta = 0;
    recording.tumble_factor = 0.996 + 0.002 * i;
    found.push_back(findRuns(recording, recordRuns(recording)));
  }
  const RunStatistics dut =
      runStatistics(rtpLaw(3, 0.5), {&found[0], &found[1], &found[2], &found[3]});

  EXPECT_EQ(dut.problem, "");
  ASSERT_NE(dut.find("gamma"), nullptr);
  EXPECT_NEAR(dut.find("gamma")->value, 3, 4 * dut.find("gamma")->sigma);
  EXPECT_NEAR(dut.find("v")->value, 0.05, 1e-5);
  EXPECT_NEAR(dut.find("tau_t")->value, 0.5 * 0.999, 2e-4);
}

TEST(RunStatistics, PoolsRobotsAsOneSample) {
  std::vector<FoundRuns> found;
  for (unsigned i = 0; i < 4; ++i) {
    RunRecording recording = twoMinutes(40 + i);
    recording.sigma = i < 2 ? 0.0003 : 0.0008;
    found.push_back(findRuns(recording, recordRuns(recording)));
  }
  const RunStatistics dut =
      runStatistics(rtpLaw(3, 0.5), {&found[0], &found[1], &found[2], &found[3]});
  const RunStatistics one = runStatistics(rtpLaw(3, 0.5), {&found[0]});

  EXPECT_LT(std::abs(dut.find("gamma")->value - 3), 4 * dut.find("gamma")->sigma);
  EXPECT_NEAR(dut.find("gamma")->sigma, one.find("gamma")->sigma / 2,
              0.15 * dut.find("gamma")->sigma);
  EXPECT_EQ(dut.runs + dut.hidden + 0, dut.tumbles);
  EXPECT_EQ(
      dut.exponential.p,
      runStatistics(rtpLaw(3, 0.5), {&found[0], &found[1], &found[2], &found[3]}).exponential.p);
}

/// In how many of 20 recordings of two minutes (about 140 runs) a test rejects at 1 %.
template <class Change, class Test>
int rejections(Change change, Test test) {
  int count = 0;
  for (unsigned i = 0; i < 20; ++i) {
    RunRecording recording = twoMinutes(60 + i);
    change(recording);
    count += test(statisticsOf(recording)).p < 0.01 ? 1 : 0;
  }
  return count;
}

TEST(WrongPrograms, RunsOfOneLengthAreRejectedAlways) {
  EXPECT_EQ(
      rejections([](RunRecording& recording) { recording.run = [](auto&) { return 1.0 / 3; }; },
                 [](const RunStatistics& dut) { return dut.exponential; }),
      20);
}

TEST(WrongPrograms, RunsOfTwoStagesAreRejectedInTwoRecordingsOfThree) {
  const auto two_stages = [](RunRecording& recording) {
    recording.run = [](std::mt19937_64& random) {
      return std::gamma_distribution<double>(2, 1.0 / 6)(random);
    };
  };
  EXPECT_GT(rejections(two_stages, [](const RunStatistics& dut) { return dut.exponential; }), 12);
}

TEST(WrongPrograms, RunsRoundedUpToATickAreRejected) {
  // With ticks of 100 ms the mean is 16 % too long.
  const auto ticks = [](RunRecording& recording) {
    recording.duration = 300;
    recording.run = [](std::mt19937_64& random) {
      return 0.1 * std::ceil(std::exponential_distribution<double>(3)(random) / 0.1);
    };
  };
  EXPECT_EQ(rejections(ticks, [](const RunStatistics& dut) { return dut.exponential; }), 20);
}

TEST(WrongPrograms, PreferredAnglesAreRejected) {
  const auto forward = [](RunRecording& recording) {
    recording.turn = [](std::mt19937_64& random) {
      return std::normal_distribution<double>(0, 1.5)(random);
    };
  };
  EXPECT_GT(rejections(forward, [](const RunStatistics& dut) { return dut.uniform; }), 17);
  EXPECT_GT(rejections(forward, [](const RunStatistics& dut) { return dut.preferred; }), 17);
}

TEST(WrongPrograms, AnotherRateIsDetected) {
  int outside = 0;
  for (unsigned i = 0; i < 20; ++i) {
    RunRecording recording = twoMinutes(60 + i);
    recording.duration = 600;
    recording.run = [](std::mt19937_64& random) {
      return std::exponential_distribution<double>(3.6)(random);
    };
    const RunStatistics dut = statisticsOf(recording);
    outside += dut.find("gamma")->low95 > 3 ? 1 : 0;
  }
  EXPECT_GT(outside, 17);
}

TEST(Wheels, FullTurnsAndFastTumblesAreReported) {
  RunRecording recording = twoMinutes(9);
  recording.law = recording.law.with("tau_t", 0.4);
  recording.turn = [](std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(0, 2 * std::numbers::pi)(random);
  };
  const RunStatistics dut = statisticsOf(recording);

  EXPECT_NEAR(dut.beyond_half_turn, 0.45, 0.15);
  EXPECT_GT(dut.needed_wheel_speed, 0.27);
  EXPECT_GT(dut.wheel_speed, 0.5);
}

}  // namespace
}  // namespace lab::analysis
