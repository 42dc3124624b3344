#include "runner/campaign/power_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "common/math/random.hpp"

namespace lab::runner::campaign::power_law_test {
namespace {

/// D_r = epsilon eta^2 / 6 over 6 x 5 points; estimates are mean squares, as those of D_r.
std::vector<PowerLawPoint> scan(Random& random, double samples) {
  std::vector<PowerLawPoint> points;
  for (const double eta : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0}) {
    for (const double epsilon : {0.1, 0.2, 0.4, 0.6, 0.9}) {
      double squares = 0;
      for (int i = 0; i < static_cast<int>(samples); ++i) {
        const double z = random.normal();
        squares += z * z / samples;
      }
      const double value = epsilon * eta * eta / 6 * squares;
      points.push_back({{eta, epsilon}, value, value * std::sqrt(2 / samples)});
    }
  }
  return points;
}

TEST(PowerLaw, IsFoundExactlyWithoutErrors) {
  const auto law = fitPowerLaw({{{1, 1}, 0.5, 0.01},
                                {{2, 1}, 2, 0.01},
                                {{1, 3}, 1.5, 0.01},
                                {{4, 5}, 40, 0.01},
                                {{3, 2}, 9, 0.01}});

  ASSERT_TRUE(law.has_value());
  EXPECT_NEAR(law->prefactor.value, 0.5, 1e-9);
  EXPECT_NEAR(law->exponents[0].value, 2, 1e-9);
  EXPECT_NEAR(law->exponents[1].value, 1, 1e-9);
  EXPECT_NEAR(law->chi2, 0, 1e-9);
  EXPECT_EQ(law->freedom, 2);
}

TEST(PowerLaw, HasIntervalsThatHoldTheTruthIn95PercentOfTheScans) {
  constexpr int kScans = 2000;
  Random random(5);
  int prefactor = 0;
  int eta = 0;
  int epsilon = 0;
  double mean = 0;
  double low_p = 0;
  for (int i = 0; i < kScans; ++i) {
    const auto law = fitPowerLaw(scan(random, 60));
    ASSERT_TRUE(law.has_value());
    const auto holds = [](const FittedNumber& n, double truth) {
      return n.low95 <= truth && truth <= n.high95 ? 1 : 0;
    };
    prefactor += holds(law->prefactor, 1.0 / 6);
    eta += holds(law->exponents[0], 2);
    epsilon += holds(law->exponents[1], 1);
    mean += law->prefactor.value / kScans;
    if (law->p < 0.01) low_p += 1.0 / kScans;
  }

  // The standard error of each share is 0.5 %.
  for (const int held : {prefactor, eta, epsilon}) {
    EXPECT_GT(held, 0.93 * kScans);
    EXPECT_LT(held, 0.975 * kScans);
  }
  // Least squares of logarithms would be low by a sixtieth.
  EXPECT_NEAR(mean, 1.0 / 6, 0.005 / 6);
  EXPECT_LT(low_p, 0.03);
}

TEST(PowerLaw, SaysWhenThePointsFollowNone) {
  std::vector<PowerLawPoint> points;
  for (const double x : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
    points.push_back({{x}, 1 + std::exp(x), 0.01 * (1 + std::exp(x))});
  }

  EXPECT_LT(fitPowerLaw(points)->p, 1e-6);
}

TEST(PowerLaw, NeedsPositiveNumbersAndDifferentKeys) {
  EXPECT_FALSE(fitPowerLaw({{{1}, -1, 0.1}, {{2}, 1, 0.1}, {{3}, 2, 0.1}}));
  EXPECT_FALSE(fitPowerLaw({{{0}, 1, 0.1}, {{2}, 1, 0.1}, {{3}, 2, 0.1}}));
  EXPECT_FALSE(fitPowerLaw({{{1}, 1, 0.1}, {{2}, 1, 0.1}}));
  EXPECT_FALSE(fitPowerLaw({{{2}, 1, 0.1}, {{2}, 1, 0.1}, {{2}, 2, 0.1}}));
  EXPECT_FALSE(fitPowerLaw({}));
}

TEST(PowerLaw, OfCommonRandomNumbersHasTheScatterBetweenSets) {
  // All points of a set share an error of 10 %: the fit of one set does not see it.
  constexpr int kScans = 400;
  Random random(9);
  int by_sets = 0;
  int as_if_independent = 0;
  for (int i = 0; i < kScans; ++i) {
    std::vector<std::vector<PowerLawPoint>> sets;
    std::vector<PowerLawPoint> all;
    for (int set = 0; set < 6; ++set) {
      const double common = 1 + 0.1 * random.normal();
      std::vector<PowerLawPoint> points = scan(random, 2000);
      for (PowerLawPoint& point : points) point.value *= common;
      all.insert(all.end(), points.begin(), points.end());
      sets.push_back(std::move(points));
    }
    const auto law = fitPowerLawBySets(sets);
    ASSERT_TRUE(law.has_value());
    if (law->prefactor.low95 <= 1.0 / 6 && 1.0 / 6 <= law->prefactor.high95) ++by_sets;
    const auto one = fitPowerLaw(all);
    if (one->prefactor.low95 <= 1.0 / 6 && 1.0 / 6 <= one->prefactor.high95) ++as_if_independent;
  }

  EXPECT_GT(by_sets, 0.91 * kScans);
  EXPECT_LT(as_if_independent, 0.7 * kScans);
  EXPECT_FALSE(fitPowerLawBySets({scan(random, 20), scan(random, 20)}));
}

}  // namespace
}  // namespace lab::runner::campaign::power_law_test
