#include "analyzer/laws/bp_kurtosis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/analyzer/laws/window_moments.hpp"

namespace lab::analysis {
namespace {

constexpr double kBase = 0.075;

/// Independent windows of the executed process from a random phase: exact arcs.
std::vector<WindowMoments> simulate(double amplitude, double epsilon,
                                    const std::vector<double>& lags, int robots, double sigma) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> wheel(-amplitude, amplitude);
  std::uniform_real_distribution<double> phase(0, epsilon);
  std::normal_distribution<double> noise(0, sigma > 0 ? std::sqrt(2.0) * sigma : 1);
  std::vector<WindowMoments> moments(lags.size());
  for (int robot = 0; robot < robots; ++robot) {
    double left = phase(random);
    double l = wheel(random);
    double r = wheel(random);
    double x = 0;
    double y = 0;
    double theta = 0;
    double time = 0;
    for (std::size_t i = 0; i < lags.size(); ++i) {
      while (time < lags[i]) {
        const double dt = std::min(left, lags[i] - time);
        const double half = 0.5 * (r - l) / kBase * dt;
        const double chord = 0.5 * (l + r) * dt * (half == 0 ? 1 : std::sin(half) / half);
        x += chord * std::cos(theta + half);
        y += chord * std::sin(theta + half);
        theta += 2 * half;
        time += dt;
        left -= dt;
        if (left <= 0) {
          left = epsilon;
          l = wheel(random);
          r = wheel(random);
        }
      }
      const double dx = x + (sigma > 0 ? noise(random) : 0);
      const double dy = y + (sigma > 0 ? noise(random) : 0);
      moments[i].add(dx * dx + dy * dy);
    }
  }
  return moments;
}

TEST(BpKurtosis, AgreesWithSimulatedRobotsAlsoForLargeTurnsPerHold) {
  struct Case {
    double amplitude;
    double epsilon;
  };
  // The last one turns by up to 4.8 rad in a hold.
  for (const Case& one : {Case{0.07, 0.2}, Case{0.10, 0.4}, Case{0.45, 0.4}}) {
    const double e = one.epsilon;
    const std::vector<double> lags = {0.1 * e, 0.7 * e, e, 1.3 * e, 2.5 * e, 5 * e, 20 * e, 60 * e};
    const auto moments = simulate(one.amplitude, e, lags, 100'000, 0);
    const BpKurtosis dut(one.amplitude, kBase, e);
    for (std::size_t i = 0; i < lags.size(); ++i) {
      EXPECT_LT(std::abs(moments[i].kurtosisZ(dut.kurtosis(lags[i]))), 4)
          << one.amplitude << " at " << lags[i] << ": " << moments[i].kurtosis() << " "
          << dut.kurtosis(lags[i]);
    }
  }
}

TEST(BpKurtosis, TakesNoiseIntoAccount) {
  const double sigma = 0.001;
  const std::vector<double> lags = {0.02, 0.2, 0.6, 2};
  const auto moments = simulate(0.03, 0.2, lags, 100'000, sigma);
  const BpKurtosis dut(0.03, kBase, 0.2);
  for (std::size_t i = 0; i < lags.size(); ++i) {
    EXPECT_LT(std::abs(moments[i].kurtosisZ(dut.observed(lags[i], 4 * sigma * sigma))), 4) << i;
  }
  EXPECT_NEAR(dut.observed(0.01, 1), 2, 1e-4);  // all noise
}

TEST(BpKurtosis, HasTheLimitsOfOneAndTwoDimensions) {
  // A straight piece of one hold: <v^4> / <v^2>^2 of the mean of two uniform draws is 2.4.
  const BpKurtosis dut(0.07, kBase, 0.2);
  EXPECT_NEAR(dut.kurtosis(1e-4), 2.4, 2e-3);
  EXPECT_NEAR(dut.kurtosis(1e5), 2, 1e-3);

  // Short holds: diffusion along an axis that turns by D_r.
  const double e = 1e-3;
  const BpKurtosis fine(0.7, kBase, e);
  const double rate = 4 * e * 0.7 * 0.7 / (3 * kBase * kBase);
  for (const double tau : {0.5, 2.0, 8.0, 40.0}) {
    const double x = rate * tau;
    EXPECT_NEAR(fine.kurtosis(tau), 2 + 2 * (x + std::expm1(-x)) / (x * x), 2e-3) << tau;
  }
}

TEST(BpKurtosis, HasTheKnownValues) {
  const BpKurtosis dut(0.07, kBase, 0.2);
  EXPECT_NEAR(dut.kurtosis(1), 2.84, 0.02);
  EXPECT_NEAR(dut.kurtosis(4), 2.74, 0.02);
  EXPECT_NEAR(dut.kurtosis(17), 2.39, 0.02);
  EXPECT_NEAR(dut.kurtosis(85), 2.09, 0.02);
  EXPECT_NEAR(dut.kurtosis(340), 2.01, 0.02);
}

}  // namespace
}  // namespace lab::analysis
