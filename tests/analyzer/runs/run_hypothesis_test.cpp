// The tests of run times and angles: their level under the hypothesis, their power against others.
#include "analyzer/runs/run_hypothesis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lab::analysis {
namespace {

/// How often p < 0.05 in `sets` sets.
template <class Draw>
double rejected(int sets, Draw draw) {
  int count = 0;
  for (int i = 0; i < sets; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 1);
    count += draw(random).p < 0.05 ? 1 : 0;
  }
  return static_cast<double>(count) / sets;
}

constexpr int kSets = 400;
constexpr double kBand = 4 * 0.0109;  // 4 binomial standard errors of 5 % in 400

TestResult angles(std::mt19937_64& random, int n, double kick,
                  TestResult (*test)(std::span<const double>)) {
  std::uniform_real_distribution<double> uniform(-std::numbers::pi, std::numbers::pi);
  std::vector<double> all;
  for (int i = 0; i < n; ++i) {
    const double angle = uniform(random);
    all.push_back(angle + kick * std::sin(angle));
  }
  return test(all);
}

TestResult runs(std::mt19937_64& random, int n, double shape, double track) {
  std::gamma_distribution<double> draw(shape, 1 / shape);
  std::vector<WaitingTime> all;
  double left = track;
  int number = 0;
  while (static_cast<int>(all.size()) < n) {
    const double time = draw(random);
    all.push_back({std::min(time, left), time < left, number});
    left -= time;
    if (left <= 0) {
      left = track;
      ++number;
    }
  }
  // Each set its own seed: 99 common replicates would put one error into the level of all.
  return exponentialTest(all, random(), 99);
}

TEST(Kuiper, HoldsItsLevelAndDetectsAPreferredAngle) {
  EXPECT_NEAR(rejected(kSets, [](auto& r) { return angles(r, 60, 0, kuiperTest); }), 0.05, kBand);
  EXPECT_GT(rejected(kSets, [](auto& r) { return angles(r, 300, 0.6, kuiperTest); }), 0.95);
}

TEST(Rayleigh, HoldsItsLevelAndDetectsAPreferredAngle) {
  EXPECT_NEAR(rejected(kSets, [](auto& r) { return angles(r, 60, 0, rayleighTest); }), 0.05, kBand);
  EXPECT_GT(rejected(kSets, [](auto& r) { return angles(r, 300, 0.6, rayleighTest); }), 0.95);
}

TEST(Exponential, HoldsItsLevelWithAndWithoutCuts) {
  EXPECT_NEAR(rejected(kSets, [](auto& r) { return runs(r, 100, 1, 1e9); }), 0.05, kBand);
  EXPECT_NEAR(rejected(kSets, [](auto& r) { return runs(r, 100, 1, 3); }), 0.05, kBand);
}

TEST(Exponential, DetectsAgeDependentRuns) {
  EXPECT_GT(rejected(kSets, [](auto& r) { return runs(r, 100, 2, 1e9); }), 0.9);
  EXPECT_GT(rejected(kSets, [](auto& r) { return runs(r, 100, 2, 10); }), 0.8);
  EXPECT_EQ(rejected(20, [](auto& r) { return runs(r, 50, 1e6, 1e9); }), 1);
}

TEST(Correlation, HoldsItsLevelAndDetectsMemory) {
  const auto pairs = [](auto& random, double memory) {
    std::exponential_distribution<double> draw(1);
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 0; i < 200; ++i) {
      a.push_back(draw(random));
      b.push_back(memory * a.back() + (1 - memory) * draw(random));
    }
    return correlationTest(a, b);
  };
  EXPECT_NEAR(rejected(kSets, [&](auto& r) { return pairs(r, 0); }), 0.05, kBand);
  EXPECT_GT(rejected(kSets, [&](auto& r) { return pairs(r, 0.3); }), 0.99);
}

TEST(Tests, GiveNanForTooFewData) {
  const std::vector<double> few{0.1, 0.2};
  EXPECT_TRUE(std::isnan(kuiperTest(few).p));
  EXPECT_TRUE(std::isnan(rayleighTest(few).p));
  EXPECT_TRUE(std::isnan(correlationTest(few, few).p));
  EXPECT_TRUE(std::isnan(exponentialTest({}, 1).p));
}

}  // namespace
}  // namespace lab::analysis
