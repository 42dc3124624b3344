#include "light/field/noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "robot/dynamics/rng.hpp"

namespace lab::light {
namespace {

double noiseAt(std::uint64_t seed, double x, double y, double phase) {
  const Noise noise(seed, phase);
  return NoiseReader(noise).at(x, y);
}

/// Uniform in [0, 1).
double draw(std::uint64_t& state) {
  return static_cast<double>(dynamics::splitMix64(state) >> 11U) * 0x1.0p-53;
}

TEST(NormalShareBelow, AgreesWithTheErrorFunction) {
  for (double z = -6; z <= 6; z += 0.01) {
    EXPECT_NEAR(normalShareBelow(z), 0.5 * std::erfc(-z / std::numbers::sqrt2), 1.5e-7) << z;
  }
}

// Patterns must not change between machines or versions, because experiments are repeated by their
// seed.
TEST(Noise, IsBitEqualToStoredValues) {
  EXPECT_EQ(noiseAt(1, 0.25, -3.5, 0), 0x1.162ddeaf1db4dp-2);
  EXPECT_EQ(noiseAt(1, 1000.125, 2000.75, 17.375), 0x1.96fd3a41ad646p-1);
  EXPECT_EQ(noiseAt(0xFFFFFFFFFFFFFFFFU, -0.5, 0.5, -2.5), 0x1.c7f4352df9b13p-1);
}

TEST(Noise, DoesNotDependOnTheOrderOfReading) {
  const Noise noise(7, 0.3);
  NoiseReader there(noise);
  std::array<double, 400> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = there.at(-5 + 0.025 * static_cast<double>(i), 0.7);
  }
  NoiseReader back(noise);
  for (std::size_t i = values.size(); i-- > 0;) {
    ASSERT_EQ(back.at(-5 + 0.025 * static_cast<double>(i), 0.7), values[i]);
  }
}

// Values of many patterns at one place are uniform over 0..1, wherever the place is between lattice
// points. Chi-squared over 20 bins: 19 degrees of freedom, above 51.9 with probability 1 / 15 000.
TEST(Noise, IsUniformAtEveryPlace) {
  constexpr std::size_t kPatterns = 20000;
  constexpr std::size_t kShares = 20;
  const std::array<std::array<double, 3>, 5> places = {
      {{0, 0, 0}, {0.5, 0.5, 0.5}, {0.5, 0, 0.25}, {3.2, -7.9, 100.6}, {0.25, 0.75, 0}}};
  double largest = 0;
  for (const auto& place : places) {
    std::array<std::size_t, kShares> counts{};
    double sum = 0;
    double squares = 0;
    for (std::uint64_t seed = 0; seed < kPatterns; ++seed) {
      const double value = noiseAt(seed, place[0], place[1], place[2]);
      ASSERT_GE(value, 0);
      ASSERT_LT(value, 1);
      ++counts[static_cast<std::size_t>(value * kShares)];
      sum += value;
      squares += (value - 0.5) * (value - 0.5);
    }
    const double expected = static_cast<double>(kPatterns) / kShares;
    double chi_squared = 0;
    for (const std::size_t count : counts) {
      const double off = static_cast<double>(count) - expected;
      chi_squared += off * off / expected;
    }
    EXPECT_LT(chi_squared, 51.9) << place[0] << ", " << place[1] << ", " << place[2];
    // Variances of a value and of its squared distance from 1/2: 1/12 and 1/80 - 1/144.
    const double n = static_cast<double>(kPatterns);
    largest = std::max({largest, std::abs(sum / n - 0.5) / std::sqrt(1.0 / 12 / n),
                        std::abs(squares / n - 1.0 / 12) / std::sqrt((1.0 / 80 - 1.0 / 144) / n)});
  }
  EXPECT_LT(largest, 4);
  RecordProperty("largest_z", std::to_string(largest));
}

/// rho of the underlying normal field at two places this far apart, averaged over places.
double correlation(double dx, double dy, double phase, std::size_t pairs) {
  std::uint64_t state = 11;
  double sum = 0;
  for (std::uint64_t seed = 0; seed < pairs; ++seed) {
    const double x = draw(state);
    const double y = draw(state);
    const double p = draw(state);
    sum += (noiseAt(seed, x, y, p) - 0.5) * (noiseAt(seed, x + dx, y + dy, p + phase) - 0.5);
  }
  const double of_values = 12 * sum / static_cast<double>(pairs);
  return 2 * std::sin(std::numbers::pi / 6 * of_values);
}

TEST(Noise, HasItsCorrelationInEveryDirectionAndInPhase) {
  constexpr std::size_t kPairs = 20000;
  const double scatter = 4 / std::sqrt(static_cast<double>(kPairs));
  for (const double angle : {0.0, std::numbers::pi / 8, std::numbers::pi / 4, 2.0}) {
    for (const double distance : {0.5, 1.0, 1.5}) {
      EXPECT_NEAR(correlation(distance * std::cos(angle), distance * std::sin(angle), 0, kPairs),
                  std::exp(-distance * distance), 0.04 + scatter)
          << distance << " at " << angle;
    }
  }
  for (const double later : {0.5, 1.0, 1.5}) {
    EXPECT_NEAR(correlation(0, 0, later, kPairs), std::exp(-later * later), 0.04 + scatter)
        << later;
  }
}

TEST(Noise, IsUncorrelatedThreeSizesAwayAndBetweenSeeds) {
  constexpr std::size_t kPairs = 20000;
  const double scatter = 4 / std::sqrt(static_cast<double>(kPairs));
  EXPECT_NEAR(correlation(3, 0, 0, kPairs), 0, scatter);
  EXPECT_NEAR(correlation(0, -3, 0, kPairs), 0, scatter);
  EXPECT_NEAR(correlation(0, 0, 3, kPairs), 0, scatter);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < kPairs; ++seed) {
    sum += (noiseAt(seed, 0.3, 0.3, 0) - 0.5) * (noiseAt(seed + 1, 0.3, 0.3, 0) - 0.5);
  }
  EXPECT_NEAR(12 * sum / static_cast<double>(kPairs), 0, scatter);
}

// Continuous, with a continuous slope, where the nearest lattice point changes in place or phase.
TEST(Noise, IsSmoothAcrossLatticePoints) {
  constexpr double kStep = 1e-6;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto slopes_meet = [&](auto&& at) {
      const double before = (at(0.5) - at(0.5 - kStep)) / kStep;
      const double after = (at(0.5 + kStep) - at(0.5)) / kStep;
      EXPECT_NEAR(before, after, 1e-3);
    };
    slopes_meet([&](double x) { return noiseAt(seed, x, 0.2, 0.1); });
    slopes_meet([&](double y) { return noiseAt(seed, 0.2, y, 0.1); });
    slopes_meet([&](double phase) { return noiseAt(seed, 0.2, 0.3, phase); });
  }
}

}  // namespace
}  // namespace lab::light
