#include "robot/dynamics/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lab::dynamics {
namespace {

constexpr double kUnit = 65536;

TEST(NegativeLog, IsTheLogarithmWithinThreeInAHundredThousand) {
  for (uint64_t bits = 1; bits < (1ULL << 32); bits += 8191) {
    const double u = std::ldexp(static_cast<double>(bits | 1U), -32);
    ASSERT_NEAR(negativeLog(static_cast<uint32_t>(bits)) / kUnit, -std::log(u), 3e-5) << bits;
  }
}

TEST(NegativeLog, HasBoundedResults) {
  EXPECT_NEAR(negativeLog(0) / kUnit, 32 * std::log(2.0), 3e-5);
  EXPECT_EQ(negativeLog(0xFFFFFFFFU), 0U);
}

TEST(NegativeLog, HasMeanAndMeanSquareOfTheExponentialLaw) {
  // Every 1021st of the 2^32 inputs: a deterministic quadrature, not a random sample.
  double sum = 0;
  double sum2 = 0;
  double n = 0;
  for (uint64_t bits = 510; bits < (1ULL << 32); bits += 1021) {
    const double e = negativeLog(static_cast<uint32_t>(bits)) / kUnit;
    sum += e;
    sum2 += e * e;
    ++n;
  }
  EXPECT_NEAR(sum / n, 1.0, 1e-4);
  EXPECT_NEAR(sum2 / n, 2.0, 4e-4);
}

TEST(ExponentialMs, HasTheGivenMeanWithoutRoundingBias) {
  constexpr int kDraws = 10000000;
  for (const uint32_t mean_us : {1000000U, 333333U, 20000U}) {
    Rng rng(mean_us);
    double sum = 0;
    for (int i = 0; i < kDraws; ++i) {
      sum += exponentialMs(rng, mean_us);
    }
    const double mean_ms = mean_us * 1e-3;
    const double z = (sum / kDraws - mean_ms) / (mean_ms / std::sqrt(kDraws));
    // Rounding up would add 0.5 ms, which is z = 79 at the shortest of these means.
    EXPECT_LT(std::abs(z), 4) << mean_us;
  }
}

TEST(ExponentialMs, HasTheExactDistribution) {
  constexpr int kDraws = 1000000;
  constexpr int kBins = 60;  // bins of 50 ms; the last one is open
  const double mean_ms = 500;
  Rng rng(11);
  std::vector<double> count(kBins);
  for (int i = 0; i < kDraws; ++i) {
    ++count[std::min<size_t>(exponentialMs(rng, 500000) / 50, kBins - 1)];
  }
  double chi2 = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    // A draw rounded to k ms represents times in [k - 1/2, k + 1/2).
    const double low = bin == 0 ? 0 : bin * 50 - 0.5;
    const double above = bin == kBins - 1 ? 0 : std::exp(-(bin * 50 + 49.5) / mean_ms);
    const double expected = kDraws * (std::exp(-low / mean_ms) - above);
    chi2 += std::pow(count[static_cast<size_t>(bin)] - expected, 2) / expected;
  }
  EXPECT_LT(std::abs(chi2 - (kBins - 1)) / std::sqrt(2.0 * (kBins - 1)), 4);
}

TEST(ExponentialMs, DoesNotOverflowAtTheLongestMean) {
  Rng rng(5);
  double sum = 0;
  for (int i = 0; i < 1000000; ++i) {
    const uint32_t ms = exponentialMs(rng, kLongestMeanUs);
    ASSERT_LT(ms, 2300000U);
    sum += ms;
  }
  EXPECT_LT(std::abs(sum / 1e6 - 1e5) / 1e2, 4);
}

}  // namespace
}  // namespace lab::dynamics
