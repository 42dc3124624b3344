#include "runner/campaign/twins/twin_regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace lab::runner::campaign {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A simulation with two parameters, of which twelve numbers with correlated scatter are measured.
/// Two of them depend on no parameter, one is missing in the run, one never varies.
std::vector<double> measure(double a, double b, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double common = normal(random);
  std::vector<double> numbers;
  for (int i = 0; i < 8; ++i) {
    const double share = i / 7.0;
    numbers.push_back(10 + 4 * share * a + 3 * (1 - share) * b + 0.3 * a * a +
                      0.4 * (common + normal(random)));
  }
  numbers.push_back(normal(random));
  numbers.push_back(common);
  numbers.push_back(a);
  numbers.push_back(5);
  return numbers;
}

struct Trial {
  std::vector<Look> looks;
  std::vector<std::vector<double>> drawn;
};

Trial trial(double a, double b, int twins, std::mt19937_64& random) {
  std::uniform_real_distribution<double> range(-1.5, 1.5);
  Trial made;
  std::vector<double> run = measure(a, b, random);
  run[10] = kNan;
  for (const double number : run) made.looks.push_back({"look", number, {}});
  for (int i = 0; i < twins; ++i) {
    made.drawn.push_back({range(random), range(random)});
    const std::vector<double> twin = measure(made.drawn.back()[0], made.drawn.back()[1], random);
    for (std::size_t k = 0; k < twin.size(); ++k) made.looks[k].twins.push_back(twin[k]);
  }
  return made;
}

TEST(TwinRegression, IntervalsHoldTheParametersOfTheRun) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> inside(-1, 1);
  constexpr int kTrials = 400;
  int covered = 0;
  double squares = 0;
  double sum = 0;
  for (int i = 0; i < kTrials; ++i) {
    const double a = inside(random);
    const double b = inside(random);
    const Trial one = trial(a, b, 100, random);
    const TwinEstimates dut = estimateParameters(one.looks, one.drawn);
    for (const double z :
         {(dut.values[0] - a) / dut.sigmas[0], (dut.values[1] - b) / dut.sigmas[1]}) {
      covered += std::abs(z) < 1.96 ? 1 : 0;
      squares += z * z;
      sum += z;
    }
    EXPECT_GT(dut.known[0], 0.8);
    EXPECT_GT(dut.known[1], 0.7);
  }
  // 95 % of 800; its standard deviation is 0.8 %, that of the mean square 5 %.
  EXPECT_NEAR(covered / (2.0 * kTrials), 0.95, 4 * 0.008);
  EXPECT_NEAR(squares / (2.0 * kTrials), 1, 0.25);
  EXPECT_LT(std::abs(sum / std::sqrt(2.0 * kTrials)), 4);
}

TEST(TwinRegression, SaysWhichParameterTheRunDoesNotKnow) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> range(-1, 1);
  std::normal_distribution<double> normal;
  Trial one;
  for (int k = 0; k < 5; ++k) one.looks.push_back({"look", 0.3, {}});
  for (int i = 0; i < 150; ++i) {
    one.drawn.push_back({range(random), range(random)});
    for (Look& look : one.looks) look.twins.push_back(one.drawn.back()[0] + 0.2 * normal(random));
  }
  const TwinEstimates dut = estimateParameters(one.looks, one.drawn);
  EXPECT_GT(dut.known[0], 0.9);
  EXPECT_LT(dut.known[1], 0.1);
}

TEST(TwinRegression, PoolsRunsByTheirErrors) {
  TwinEstimates precise{{2}, {0.1}, {{1}}, {0.9}, 100};
  TwinEstimates rough{{3}, {0.2}, {{1}}, {0.5}, 100};
  const PooledEstimates dut = poolEstimates({precise, rough});
  EXPECT_NEAR(dut.estimates.values[0], (4 * 2 + 3) / 5.0, 1e-12);
  EXPECT_NEAR(dut.estimates.sigmas[0], 1 / std::sqrt(125.0), 1e-12);
  EXPECT_NEAR(dut.p, std::erfc(1 / std::sqrt(0.05) / std::sqrt(2.0)), 1e-9);
}

TEST(TwinRegression, RefusesWhatCannotBeFitted) {
  EXPECT_THROW((void)estimateParameters({{"look", 1, {1, 2}}}, {{1}, {2}}), std::invalid_argument);
  const std::vector<Look> fixed{{"look", 1, std::vector<double>(30, 2.0)}};
  EXPECT_THROW((void)estimateParameters(fixed, std::vector<std::vector<double>>(30, {1.0})),
               std::invalid_argument);
}

}  // namespace
}  // namespace lab::runner::campaign
