// One-hour recordings between walls, a thousand in all: bias, scatter and intervals of the tumble
// rate.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "analyzer/runs/run_statistics.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"
#include "tests/analyzer/runs/run_recording.hpp"

namespace lab::analysis::run_ensemble_test {
namespace {

struct Case {
  double gamma;
  double fps;
};

constexpr int kRecordings = 125;  // of each case
constexpr int kCases = 8;

/// Rates of the recordings of all programs, relative to the truth and its bound.
struct Rates {
  Scatter relative;  ///< to the truth
  Scatter z;         ///< deviation from the truth, in Fisher's bounds of its recording
  int covered = 0;

  void add(double rate, double low, double high, double truth, double bound) {
    relative.add(rate / truth);
    z.add((rate - truth) / bound);
    covered += low <= truth && truth <= high ? 1 : 0;
  }

  /// As the project promises: bias, scatter, 95 % intervals.
  void judge(const char* what, double most_bias) const {
    std::printf("%s, %g recordings: bias %+.3f +- %.3f %%, sd %.3f of the bound, covered %.1f %%\n",
                what, relative.n, 100 * (relative.mean() - 1),
                100 * relative.deviation() / std::sqrt(relative.n), z.deviation(),
                100 * covered / relative.n);
    EXPECT_NEAR(relative.mean(), 1, most_bias) << what;
    EXPECT_NEAR(z.deviation(), 1, 0.10) << what;
    EXPECT_GE(covered, 0.93 * relative.n) << what;
    EXPECT_LE(covered, 0.97 * relative.n) << what;
  }
};

class RunEnsemble : public testing::TestWithParam<Case> {
 protected:
  static void TearDownTestSuite() {
    if (telemetry_.relative.n < kRecordings * kCases) return;  // not all cases were run
    telemetry_.judge("gamma from telemetry", 0.002);
    poses_.judge("gamma from poses", 0.006);
  }

  static inline Rates telemetry_;
  static inline Rates poses_;
};

TEST_P(RunEnsemble, RateFromTelemetryAndFromPoses) {
  const double gamma = GetParam().gamma;
  Scatter telemetry;
  Scatter poses;
  Scatter ratio;
  Scatter truncated;
  Scatter bound;
  Scatter tumble;
  int covered_telemetry = 0;
  int covered = 0;
  int covered_truncated = 0;
  int rejected = 0;
  for (int i = 0; i < kRecordings; ++i) {
    WalkerRecording recording;
    recording.law = rtpLaw(gamma, 0.5);
    recording.duration = 3600;
    recording.fps = GetParam().fps;
    recording.sigma = 0.0005;
    recording.sigma_theta = 0.025;
    recording.walls = true;
    recording.seed = 31000U + static_cast<unsigned>(i);
    const std::vector<Sample> samples = stitch(recording).samples;
    RunFinder finder(recording.law, 1 / recording.fps);
    for (const Sample& sample : samples) finder.add(sample);
    const FoundRuns found = finder.find();
    const RunStatistics dut = runStatistics(recording.law, {&found});

    // The estimate from telemetry, with its interval, as the live display has it.
    const auto tumbles =
        static_cast<double>(samples.back().tumble_count - samples.front().tumble_count);
    const double run_time = samples.back().run_time - samples.front().run_time;
    const Interval count = poissonInterval(tumbles);
    telemetry.add(tumbles / run_time);
    covered_telemetry += count.low / run_time <= gamma && gamma <= count.high / run_time ? 1 : 0;

    const Estimate& rate = *dut.find("gamma");
    const Estimate& rest = *dut.find("gamma_truncated");
    poses.add(rate.value);
    ratio.add(rate.value / (tumbles / run_time));
    truncated.add(rest.value);
    bound.add(gamma / std::sqrt(tumbles));
    tumble.add(dut.find("tau_t")->value);
    const double fisher = gamma / std::sqrt(gamma * run_time);
    telemetry_.add(tumbles / run_time, count.low / run_time, count.high / run_time, gamma, fisher);
    poses_.add(rate.value, rate.low95, rate.high95, gamma, fisher);
    covered += rate.low95 <= gamma && gamma <= rate.high95 ? 1 : 0;
    covered_truncated += rest.low95 <= gamma && gamma <= rest.high95 ? 1 : 0;
    rejected += dut.exponential.p < 0.05 ? 1 : 0;
  }
  std::printf(
      "gamma %g, %g fps: telemetry %.5f sd %.4f, poses %.5f sd %.4f, bound %.4f; poses/telemetry "
      "%.5f +- %.5f, truncated %.5f sd %.4f, tau_t %.5f; covered %d %d %d, rejected %d of %d\n",
      gamma, GetParam().fps, telemetry.mean() / gamma, telemetry.deviation() / gamma,
      poses.mean() / gamma, poses.deviation() / gamma, bound.mean() / gamma, ratio.mean(),
      ratio.deviation() / std::sqrt(ratio.n), truncated.mean() / gamma,
      truncated.deviation() / gamma, tumble.mean(), covered_telemetry, covered, covered_truncated,
      rejected, kRecordings);
  // The difference from telemetry per recording, which removes most of the scatter and shows the
  // bias.
  EXPECT_NEAR(ratio.mean(), 1, 0.003);
  EXPECT_LT(std::abs(telemetry.z(gamma)), 4);
  EXPECT_NEAR(tumble.mean(), 0.5, 0.0005);
  // 3 standard errors of the scatter of this number of recordings.
  const double slack = 3 / std::sqrt(2.0 * kRecordings);
  EXPECT_LT(poses.deviation(), (1.02 + slack) * bound.mean());
  EXPECT_GT(poses.deviation(), (0.98 - slack) * bound.mean());
  const double band = 4 * std::sqrt(0.95 * 0.05 * kRecordings);
  EXPECT_NEAR(covered, 0.95 * kRecordings, band);
  EXPECT_NEAR(covered_truncated, 0.95 * kRecordings, band);
  EXPECT_NEAR(rejected, 0.05 * kRecordings, band);
}

INSTANTIATE_TEST_SUITE_P(Walls, RunEnsemble,
                         testing::Values(Case{3, 9.94}, Case{3, 24.9}, Case{3, 49.7}, Case{3, 99.4},
                                         Case{1, 9.94}, Case{1, 24.9}, Case{1, 49.7},
                                         Case{1, 99.4}),
                         [](const auto& parameter) {
                           return "Gamma" +
                                  std::to_string(static_cast<int>(parameter.param.gamma)) + "Fps" +
                                  std::to_string(static_cast<int>(parameter.param.fps + 0.5));
                         });

}  // namespace
}  // namespace lab::analysis::run_ensemble_test
