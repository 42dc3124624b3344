#include "analyzer/curves/cos_sin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace lab::analysis {
namespace {

TEST(CosSin, IsAccurateToTwoUnitsInTheLastPlaceUpToAMillionRadians) {
  std::mt19937_64 random(3);
  for (const double largest : {1e-9, 1.0, 30.0, 1e4, 1e6}) {
    std::uniform_real_distribution<double> angle(-largest, largest);
    std::vector<double> angles(10000);
    std::generate(angles.begin(), angles.end(), [&] { return angle(random); });
    std::vector<double> cosines(angles.size());
    std::vector<double> sines(angles.size());
    cosSin(angles.data(), angles.size(), cosines.data(), sines.data());
    for (std::size_t i = 0; i < angles.size(); ++i) {
      ASSERT_NEAR(cosines[i], std::cos(angles[i]), 2.3e-16) << angles[i];
      ASSERT_NEAR(sines[i], std::sin(angles[i]), 2.3e-16) << angles[i];
    }
  }
}

TEST(CosSin, IsCorrectInAllQuarters) {
  for (int quarter = -9; quarter <= 9; ++quarter) {
    for (const double beside : {-0.7, 0.0, 0.7}) {
      const double angle = 0.5 * std::numbers::pi * quarter + beside;
      double cosine = 0;
      double sine = 0;
      cosSin(&angle, 1, &cosine, &sine);
      EXPECT_NEAR(cosine, std::cos(angle), 2.3e-16) << angle;
      EXPECT_NEAR(sine, std::sin(angle), 2.3e-16) << angle;
    }
  }
}

TEST(CosSin, GivesTheSameBitsForSingleAnglesAndArrays) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> angle(-100, 100);
  for (std::size_t n = 0; n < 9; ++n) {
    std::array<double, 9> angles{};
    std::array<double, 9> cosines{};
    std::array<double, 9> sines{};
    std::generate(angles.begin(), angles.end(), [&] { return angle(random); });
    cosSin(angles.data(), n, cosines.data(), sines.data());
    for (std::size_t i = 0; i < n; ++i) {
      double cosine = 0;
      double sine = 0;
      cosSin(&angles[i], 1, &cosine, &sine);
      EXPECT_EQ(cosine, cosines[i]);
      EXPECT_EQ(sine, sines[i]);
    }
    EXPECT_EQ(cosines[8], 0);  // and writes no farther
  }
}

TEST(CosSin, GivesNanForAnglesThatAreNotFinite) {
  const std::array<double, 3> angles{std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity()};
  std::array<double, 3> cosines{};
  std::array<double, 3> sines{};
  cosSin(angles.data(), angles.size(), cosines.data(), sines.data());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    EXPECT_TRUE(std::isnan(cosines[i]));
    EXPECT_TRUE(std::isnan(sines[i]));
  }
}

}  // namespace
}  // namespace lab::analysis
