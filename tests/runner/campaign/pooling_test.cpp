#include "runner/campaign/pooling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/math/random.hpp"

namespace lab::runner::campaign::pooling_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RunNumber runOf(double value, double sigma, double samples = 1000) {
  return {value, sigma, value - 1.96 * sigma, value + 1.96 * sigma, samples};
}

TEST(Pooling, TakesTheMeanOfTheRuns) {
  const auto pooled = pool({{runOf(1, 0.1), runOf(2, 0.1), runOf(4.5, 0.4)}});

  EXPECT_DOUBLE_EQ(pooled[0].mean, 2.5);
  EXPECT_EQ(pooled[0].runs, 3);
}

TEST(Pooling, HasTheIntervalOfStudentsTForOnePoint) {
  // 1, 2, 4.5: standard deviation 1.80278, of the mean 1.04083; t(2) = 4.302653.
  const auto pooled = pool({{runOf(1, 0.1), runOf(2, 0.1), runOf(4.5, 0.4)}});

  EXPECT_NEAR(pooled[0].sigma, 1.040833, 1e-6);
  EXPECT_NEAR(pooled[0].high95 - pooled[0].mean, 4.302653 * 1.040833, 1e-4);
  EXPECT_NEAR(pooled[0].between, std::sqrt(1.802776 * 1.802776 - 0.06), 1e-5);
}

TEST(Pooling, KeepsTheIntervalOfASingleRun) {
  const auto pooled = pool({{{3, 0.2, 2.5, 3.7, 30}}, {{4, 0.2, 3.5, 4.7, 30}}});

  EXPECT_EQ(pooled[0].mean, 3);
  EXPECT_EQ(pooled[0].sigma, 0.2);
  EXPECT_EQ(pooled[0].low95, 2.5);
  EXPECT_EQ(pooled[0].high95, 3.7);
}

TEST(Pooling, LeavesOutWhatWasNotMeasured) {
  const auto pooled = pool({{runOf(1, 0.1), {kNan, kNan, kNan, kNan, kNan}, runOf(3, 0.1)},
                            {{kNan, kNan, kNan, kNan, kNan}},
                            {}});

  EXPECT_EQ(pooled[0].runs, 2);
  EXPECT_DOUBLE_EQ(pooled[0].mean, 2);
  EXPECT_TRUE(std::isnan(pooled[1].mean));
  EXPECT_TRUE(std::isnan(pooled[2].low95));
}

TEST(Pooling, PoolsNumbersWithoutErrorsByTheirScatterAlone) {
  const auto pooled = pool({{{1, kNan, kNan, kNan, kNan}, {3, kNan, kNan, kNan, kNan}},
                            {{10, kNan, kNan, kNan, kNan}, {10, kNan, kNan, kNan, kNan}},
                            {{5, kNan, kNan, kNan, kNan}, {6, kNan, kNan, kNan, kNan}}});

  EXPECT_NEAR(pooled[0].sigma, 1, 1e-12);
  EXPECT_NEAR(pooled[0].high95 - pooled[0].mean, 12.7062, 1e-3);
  EXPECT_EQ(pooled[1].sigma, 0);
  EXPECT_TRUE(std::isnan(pooled[0].between));
}

/// A campaign of points with a common law of errors.
struct Setting {
  int points = 30;
  int runs = 3;
  double samples = 40;        ///< independent samples of a run
  double between = 0;         ///< relative standard deviation between runs
  double between_spread = 0;  ///< of its logarithm, between points
};

struct Coverage {
  double held = 0;   ///< share of the intervals that hold the mean
  double width = 0;  ///< mean half width over the true standard error
};

/// Estimates as those of D_r: a mean square of `samples` normal numbers, whose own error is known
/// from the estimate only.
Coverage coverageOf(const Setting& setting, int campaigns) {
  Random random(7);
  Coverage coverage;
  int intervals = 0;
  for (int campaign = 0; campaign < campaigns; ++campaign) {
    std::vector<std::vector<RunNumber>> points;
    std::vector<double> truths;
    std::vector<double> errors;
    for (int p = 0; p < setting.points; ++p) {
      const double truth = std::exp(2 * random.normal());
      const double between = setting.between * std::exp(setting.between_spread * random.normal());
      truths.push_back(truth);
      errors.push_back(truth * std::sqrt((between * between + 2 / setting.samples) / setting.runs));
      std::vector<RunNumber> runs;
      for (int r = 0; r < setting.runs; ++r) {
        double squares = 0;
        for (int i = 0; i < static_cast<int>(setting.samples); ++i) {
          const double z = random.normal();
          squares += z * z / setting.samples;
        }
        const double value = truth * (1 + between * random.normal()) * squares;
        runs.push_back(
            runOf(value, std::abs(value) * std::sqrt(2 / setting.samples), setting.samples));
      }
      points.push_back(std::move(runs));
    }
    const std::vector<PooledNumber> pooled = pool(points);
    for (std::size_t i = 0; i < pooled.size(); ++i) {
      ++intervals;
      if (truths[i] >= pooled[i].low95 && truths[i] <= pooled[i].high95) coverage.held += 1;
      coverage.width += (pooled[i].high95 - pooled[i].low95) / 2 / errors[i];
    }
  }
  coverage.held /= intervals;
  coverage.width /= intervals;
  return coverage;
}

TEST(Pooling, HasIntervalsThatHoldTheTruthIn95PercentOfTheCases) {
  for (const Setting& setting :
       {Setting{30, 3, 40, 0, 0}, Setting{30, 2, 40, 0, 0}, Setting{30, 5, 40, 0.3, 0},
        Setting{30, 3, 200, 0.1, 0}, Setting{9, 3, 100, 0.1, 0.5}, Setting{100, 2, 100, 0.2, 0.3},
        Setting{1, 4, 100, 0.2, 0}, Setting{2, 3, 100, 0.2, 0}}) {
    const Coverage coverage = coverageOf(setting, 6000 / setting.points);

    // 6000 intervals have a standard error of 0.3 %; those of one campaign are not independent.
    EXPECT_GT(coverage.held, 0.93) << setting.points << " x " << setting.runs;
    EXPECT_LT(coverage.held, 0.97) << setting.points << " x " << setting.runs;
  }
}

TEST(Pooling, BorrowsTheVarianceOfTheOtherPoints) {
  // Student's t with two degrees of freedom: 4.30 standard errors, scattering; with the prior about
  // 2.
  EXPECT_LT(coverageOf({30, 3, 100, 0.2, 0}, 100).width, 2.3);
  EXPECT_GT(coverageOf({1, 3, 100, 0.2, 0}, 1000).width, 3.5);
}

TEST(Pooling, SeesAVarianceThatTheRunsDoNotKnow) {
  // Fixed effects, the inverse squared errors, would give 0.0141 for each mean.
  Random random(3);
  std::vector<std::vector<RunNumber>> points(20);
  for (auto& point : points) {
    for (int i = 0; i < 4; ++i) point.push_back(runOf(1 + 0.2 * random.normal(), 0.02));
  }
  double between = 0;
  for (const PooledNumber& number : pool(points)) between += number.between / 20;

  EXPECT_NEAR(between, 0.2, 0.03);
}

}  // namespace
}  // namespace lab::runner::campaign::pooling_test
