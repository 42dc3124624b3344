#include "common/math/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace lab {
namespace {

constexpr int kDraws = 1'000'000;

/// Deviation of the mean of `values` from its expectation in standard errors, for values of
/// variance `variance`.
template <class Draw>
double zOfMean(Draw draw, double expected, double variance, int count = kDraws) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += draw();
  return (sum / count - expected) / std::sqrt(variance / count);
}

TEST(Mix64, IsSplitmix64) {  // the published sequence of seed 1234567
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;
  constexpr std::array<std::uint64_t, 5> kPublished{6457827717110365317U, 3203168211198807973U,
                                                    9817491932198370423U, 4593380528125082431U,
                                                    16408922859458223821U};
  std::uint64_t state = 1234567;
  for (const std::uint64_t value : kPublished) {
    EXPECT_EQ(mix64(state), value);
    state += kGolden;
  }
}

TEST(Random, IsTheSameOnEveryMachine) {
  Random dut(1);
  EXPECT_EQ(dut.next(), 6791897765849424158U);
  EXPECT_EQ(dut.next(), 17405687883870564846U);
  EXPECT_EQ(Random(1, 2).next(), 16613338946343043936U);
  EXPECT_EQ(deriveSeed(1, 2, "noise"), 13177264639149445301U);
  EXPECT_DOUBLE_EQ(Random(1).uniform(), 0.36818951565166946);
  EXPECT_NEAR(Random(1).normal(), 0.89867742549064622, 1e-14);
}

TEST(Random, HasTheMomentsOfTheUniformDistribution) {
  Random dut(11);
  const auto power = [&dut](int n) { return [&dut, n] { return std::pow(dut.uniform(), n); }; };
  for (int n = 1; n <= 4; ++n) {
    const double mean = 1.0 / (n + 1);
    EXPECT_LT(std::abs(zOfMean(power(n), mean, 1.0 / (2 * n + 1) - mean * mean)), 4) << n;
  }
}

TEST(Random, HasTheMomentsOfTheNormalDistribution) {
  Random dut(12);
  const auto power = [&dut](int n) { return [&dut, n] { return std::pow(dut.normal(), n); }; };
  EXPECT_LT(std::abs(zOfMean(power(1), 0, 1)), 4);
  EXPECT_LT(std::abs(zOfMean(power(2), 1, 2)), 4);
  EXPECT_LT(std::abs(zOfMean(power(3), 0, 15)), 4);
  EXPECT_LT(std::abs(zOfMean(power(4), 3, 105 - 9)), 4);
}

TEST(Random, FillsTheUnitIntervalEvenly) {
  constexpr std::size_t kBins = 1000;
  std::vector<double> bins(kBins);
  Random dut(13);
  for (int i = 0; i < kDraws; ++i) ++bins[static_cast<std::size_t>(dut.uniform() * kBins)];
  double chi2 = 0;
  for (const double count : bins) chi2 += std::pow(count - kDraws / 1e3, 2) / (kDraws / 1e3);
  EXPECT_LT(std::abs((chi2 - (kBins - 1)) / std::sqrt(2.0 * (kBins - 1))), 4);
}

TEST(Random, HasIndependentSuccessiveDraws) {
  Random dut(14);
  double last = dut.uniform() - 0.5;
  const auto product = [&] {
    const double now = dut.uniform() - 0.5;
    const double value = last * now;
    last = now;
    return value;
  };
  EXPECT_LT(std::abs(zOfMean(product, 0, 1.0 / 144)), 4);
}

TEST(Random, StreamsOfNeighbouringSeedsAreUncorrelated) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random one(seed);
    Random next(seed + 1);
    Random stream(seed, 1);
    const auto neighbours = [&] { return (one.uniform() - 0.5) * (next.uniform() - 0.5); };
    EXPECT_LT(std::abs(zOfMean(neighbours, 0, 1.0 / 144, 100'000)), 4) << seed;
    const auto streams = [&] { return (one.uniform() - 0.5) * (stream.uniform() - 0.5); };
    EXPECT_LT(std::abs(zOfMean(streams, 0, 1.0 / 144, 100'000)), 4) << seed;
  }
}

TEST(DeriveSeed, DiffersBySeedOwnerAndPurpose) {
  std::set<std::uint64_t> seeds;
  int derived = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (std::int64_t owner = -1; owner < 1000; ++owner) {
      for (const char* purpose : {"", "program", "start", "start1", "1start", "noise"}) {
        seeds.insert(deriveSeed(seed, owner, purpose));
        ++derived;
      }
    }
  }
  EXPECT_EQ(seeds.size(), static_cast<std::size_t>(derived));
}

TEST(DeriveSeed, GivesUncorrelatedFirstDrawsToConsecutiveRobots) {
  constexpr int kRobots = 100'000;
  std::int64_t robot = 0;
  const auto first = [&robot](const char* purpose, std::int64_t of) {
    return Random(deriveSeed(7, robot + of, purpose)).uniform() - 0.5;
  };
  const auto neighbours = [&] {
    const double product = first("program", 0) * first("program", 1);
    robot += 2;
    return product;
  };
  EXPECT_LT(std::abs(zOfMean(neighbours, 0, 1.0 / 144, kRobots)), 4);
  const auto purposes = [&] {
    const double product = first("program", 0) * first("sensor", 0);
    ++robot;
    return product;
  };
  EXPECT_LT(std::abs(zOfMean(purposes, 0, 1.0 / 144, kRobots)), 4);
}

}  // namespace
}  // namespace lab
