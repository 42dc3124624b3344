#include "analyzer/bootstrap/simulated_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/laws/observation.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

/// Every lag of both curves, averaged over recordings, is the law as the camera sees it.
void expectLaw(const RecordingPlan& plan, const char* what) {
  const std::vector<int> lags{1, 2, 4, 8, 16, 32, 64, 128};
  const ExactLaw exact(plan.law);
  const MeasurementModel model{plan.exposure, plan.sigma, plan.sigma_theta};
  std::vector<Scatter> curves(2 * lags.size());
  RecordingPoses poses;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    simulateRecording(plan, seed, poses);
    const std::vector<double> one = recordingCurves(poses, lags);
    for (std::size_t i = 0; i < curves.size(); ++i) curves[i].add(one[i]);
  }
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double tau = lags[i] * plan.period;
    EXPECT_LT(std::abs(curves[i].z(observedMsd(exact, model, tau))), 4) << what << tau;
    EXPECT_LT(std::abs(curves[lags.size() + i].z(observedAngularMsd(exact, model, tau))), 4)
        << what << tau;
  }
}

TEST(SimulatedRecording, FollowsTheExactLawOfEveryProgram) {
  expectLaw({abpLaw(3, 0.5), 200, 0.107, 0, 0, 0}, "ABP ");
  expectLaw({noisyLaw(0.01, 0.1, 0.1), 200, 0.107, 0, 0, 0}, "noisy ABP ");
  expectLaw({noisyLaw(0, 0.07, 0.2), 200, 0.107, 0, 0, 0}, "BP ");
  expectLaw({rtpLaw(1, 0.5), 200, 0.107, 0, 0, 0}, "RTP ");
}

TEST(SimulatedRecording, IncludesExposureAndNoise) {
  expectLaw({abpLaw(6, 0.25), 200, 0.107, 0.001, 0.05, 0}, "noise ");
  expectLaw({abpLaw(6, 0.25), 200, 0.107, 0, 0, 0.03}, "exposure ");
}

TEST(SimulatedRecording, IsTheSameForTheSameSeed) {
  const RecordingPlan plan{rtpLaw(1, 0.5), 50, 0.1, 0.001, 0.01, 0};
  RecordingPoses a;
  RecordingPoses b;
  simulateRecording(plan, 7, a);
  simulateRecording(plan, 7, b);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.theta, b.theta);
  simulateRecording(plan, 8, b);
  EXPECT_NE(a.x, b.x);
}

TEST(SimulatedRecording, RejectsInvalidPlans) {
  RecordingPoses poses;
  EXPECT_THROW(simulateRecording({ProgramLaw{}, 10, 0.1, 0, 0, 0}, 1, poses),
               std::invalid_argument);
  EXPECT_THROW(simulateRecording({abpLaw(3, 0.5), 10, 0, 0, 0, 0}, 1, poses),
               std::invalid_argument);
  EXPECT_THROW(simulateRecording({abpLaw(3, 0.5), 10, 0.1, 0, 0, 0.2}, 1, poses),
               std::invalid_argument);
}

TEST(Random, IsNormalToTheFourthMomentAndInItsTail) {
  Random dut(3);
  constexpr int kDraws = 2'000'000;
  double sum = 0;
  double sum2 = 0;
  double sum4 = 0;
  int tail = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = dut.normal();
    sum += x;
    sum2 += x * x;
    sum4 += x * x * x * x;
    tail += std::abs(x) > 3.5 ? 1 : 0;
  }
  EXPECT_LT(std::abs(sum / kDraws), 4 / std::sqrt(kDraws));
  EXPECT_LT(std::abs(sum2 / kDraws - 1), 4 * std::sqrt(2.0 / kDraws));
  EXPECT_LT(std::abs(sum4 / kDraws - 3), 4 * std::sqrt(96.0 / kDraws));
  const double expected = kDraws * std::erfc(3.5 / std::sqrt(2.0));
  EXPECT_LT(std::abs(tail - expected), 4 * std::sqrt(expected));
}

}  // namespace
}  // namespace lab::analysis
