#include "analyzer/collective/time_average.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analyzer/collective/leave_one_out.hpp"

namespace lab::collective::time_average_test {
namespace {

void add(BlockedSums& sums, std::initializer_list<double> values) {
  const std::span<double> frame = sums.frame();
  std::size_t i = 0;
  for (const double value : values) frame[i++] += value;
  sums.endFrame();
}

TEST(BlockedSums, KeepEverySumWhileBlocksMerge) {
  BlockedSums sums(2, 4);
  for (int k = 1; k <= 11; ++k) add(sums, {1.0 * k, 1});

  EXPECT_EQ(sums.framesPerBlock(), 4U);
  EXPECT_EQ(sums.blocks(), 3U);
  EXPECT_EQ(sums.sum(0, 0), 1 + 2 + 3 + 4);
  EXPECT_EQ(sums.sum(1, 0), 5 + 6 + 7 + 8);
  EXPECT_EQ(sums.sum(2, 0), 9 + 10 + 11);
  EXPECT_EQ(sums.total(1), 11);
}

TEST(BlockedSums, MayBeAddedToSeveralTimesInAFrame) {
  BlockedSums sums(1, 4);
  sums.frame()[0] += 1;
  sums.frame()[0] += 2;
  sums.endFrame();

  EXPECT_EQ(sums.total(0), 3);
}

TEST(TimeAverage, OfNothingIsNan) {
  EXPECT_TRUE(std::isnan(averageOf(std::vector<double>{}).value));
  EXPECT_TRUE(std::isnan(averageOf(BlockedSums(2, 8), 0, 1).value));
}

TEST(TimeAverage, OfFewBlocksHasNoInterval) {
  const Average average = averageOf(std::vector<double>{1, 2, 3});

  EXPECT_DOUBLE_EQ(average.value, 2);
  EXPECT_TRUE(std::isnan(average.sigma));
  EXPECT_TRUE(std::isnan(average.low));
}

TEST(TimeAverage, OfAConstantHasNoInterval) {
  const Average average = averageOf(std::vector<double>(20, 0.25));

  EXPECT_EQ(average.value, 0.25);
  EXPECT_EQ(average.sigma, 0);
  EXPECT_TRUE(std::isnan(average.low));
}

TEST(TimeAverage, OfOneEventHasNoInterval) {
  std::vector<double> series(64, 0.0);
  series[20] = 3;

  const Average average = averageOf(series);

  EXPECT_GT(average.sigma, 0);
  EXPECT_TRUE(std::isnan(average.low));
}

TEST(TimeAverage, OfASeriesThatNeverForgetsHasNoInterval) {
  std::vector<double> ramp;
  for (int k = 0; k < 200; ++k) ramp.push_back(k);

  const Average average = averageOf(ramp);

  EXPECT_TRUE(std::isnan(average.low));
  EXPECT_GT(average.too_short_by, 3);
  EXPECT_LT(average.independent, 8);
}

TEST(TimeAverage, OfARatioWeighsByTheDenominator) {
  const Average average = averageOf(std::vector<double>{1, 0, 6, 0, 2, 0, 3, 0},
                                    std::vector<double>{1, 0, 3, 0, 1, 0, 1, 0});

  EXPECT_DOUBLE_EQ(average.value, 2);
}

/// A stationary series with the autocorrelation phi^t.
std::vector<double> correlated(std::size_t count, double phi, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<double> series(count);
  series[0] = normal(random) / std::sqrt(1 - phi * phi);
  for (std::size_t i = 1; i < count; ++i) series[i] = phi * series[i - 1] + normal(random);
  return series;
}

TEST(TimeAverage, KnowsTheCorrelation) {
  constexpr int kSeries = 300;
  std::mt19937_64 random(1);
  double variance = 0;
  for (int k = 0; k < kSeries; ++k) {
    const Average average = averageOf(correlated(4096, 0.8, random));
    variance += average.sigma * average.sigma / kSeries;
  }

  // That of white noise, divided by (1 - phi)^2 n. The correction for slow fluctuations only adds.
  const double ratio = variance / (1 / (0.2 * 0.2) / 4096);
  EXPECT_GT(ratio, 1);
  EXPECT_LT(ratio, 1.4);
}

/// A stationary series of an exponential autocorrelation and of white noise.
struct Case {
  std::size_t blocks;
  double lengths;  ///< of the series in correlation times; 0: only white noise
  double slow;     ///< share of the variance of the mean that the correlated part has
};

std::vector<double> mixed(const Case& of, std::mt19937_64& random) {
  const double phi = of.lengths > 0 ? std::exp(-of.lengths / static_cast<double>(of.blocks)) : 0;
  std::vector<double> series = correlated(of.blocks, phi, random);
  if (of.slow == 1) return series;
  std::normal_distribution<double> white(0, std::sqrt((1 - of.slow) / of.slow) / (1 - phi));
  for (double& value : series) value += white(random);
  return series;
}

struct Counted {
  double given = 0;
  double covered = 0;  ///< of those that are given
  double too_short_by = 0;
};

Counted count(const Case& of, int number) {
  std::mt19937_64 random(7);
  Counted counted;
  for (int k = 0; k < number; ++k) {
    const Average average = averageOf(mixed(of, random));
    if (std::isnan(average.low)) {
      counted.too_short_by += average.too_short_by;
      continue;
    }
    ++counted.given;
    if (average.low <= 0 && 0 <= average.high) ++counted.covered;
  }
  counted.too_short_by /= number - counted.given;
  counted.covered /= counted.given;
  counted.given /= number;
  return counted;
}

class Coverage : public testing::TestWithParam<Case> {};

// From 20 correlation times on.
TEST_P(Coverage, OfCorrelatedSeriesIsThatOfTheInterval) {
  const Counted counted = count(GetParam(), 4000);

  RecordProperty("covered", std::to_string(counted.covered));
  EXPECT_GT(counted.given, 0.95);
  EXPECT_GT(counted.covered, 0.93);
  EXPECT_LT(counted.covered, 0.97);
}

INSTANTIATE_TEST_SUITE_P(Series, Coverage,
                         testing::Values(Case{12, 0, 1}, Case{16, 0, 1}, Case{32, 0, 1},
                                         Case{64, 0, 1}, Case{1024, 0, 1}, Case{32, 20, 1},
                                         Case{64, 20, 1}, Case{64, 40, 1}, Case{64, 100, 1},
                                         Case{1024, 20, 1}, Case{1024, 30, 1}, Case{1024, 100, 1},
                                         Case{1024, 1000, 1}, Case{1024, 20, 0.7},
                                         Case{1024, 50, 0.7}, Case{1024, 10, 0.3},
                                         Case{1024, 20, 0.3}, Case{1024, 50, 0.3},
                                         Case{1024, 200, 0.3}));

TEST(TimeAverage, OfASeriesAsShortAsItsCorrelationMostlyHasNoInterval) {
  const Counted counted = count({1024, 1, 1}, 1000);

  EXPECT_LT(counted.given, 0.5);
  EXPECT_GT(counted.too_short_by, 2);
}

TEST(TimeAverage, OfAFunctionOfSumsHasTheErrorOfThatFunction) {
  // The square of a mean: sigma is twice the mean times that of the mean.
  std::mt19937_64 random(3);
  BlockedSums sums(2, 64);
  for (const double value : correlated(6400, 0.5, random)) add(sums, {value + 10, 1});

  const Average mean = averageOf(sums, 0, 1);
  const Average square =
      averageOfFunction(sums, [](std::span<const double> s) { return s[0] / s[1] * s[0] / s[1]; });

  EXPECT_DOUBLE_EQ(square.value, mean.value * mean.value);
  EXPECT_NEAR(square.sigma, 2 * mean.value * mean.sigma, 0.02 * square.sigma);
}

}  // namespace
}  // namespace lab::collective::time_average_test
