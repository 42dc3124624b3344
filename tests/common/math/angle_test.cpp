#include "common/math/angle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace lab {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(WrapAngle, IsTheRemainderToTheBit) {
  std::mt19937_64 random(1);
  for (const double range : {1e-300, 1.0, 4.0, 10.0, 1e3, 1e17}) {
    std::uniform_real_distribution<double> angles(-range, range);
    for (int i = 0; i < 100'000; ++i) {
      const double angle = angles(random);
      ASSERT_EQ(wrapAngle(angle), std::remainder(angle, 2 * kPi)) << angle;
    }
  }
}

TEST(WrapAngle, IsTheRemainderAroundOddMultiplesOfPi) {
  for (const double middle : {0.0, kPi, 2 * kPi, 3 * kPi, 4 * kPi, 5 * kPi}) {
    for (const double sign : {-1.0, 1.0}) {
      double angle = sign * middle;
      for (int i = 0; i < 4; ++i) angle = std::nextafter(angle, -10);
      for (int i = 0; i < 9; ++i, angle = std::nextafter(angle, 20)) {
        EXPECT_EQ(wrapAngle(angle), std::remainder(angle, 2 * kPi)) << angle;
      }
    }
  }
  EXPECT_TRUE(std::signbit(wrapAngle(-0.0)));
}

TEST(WrapAngle, OfWhatIsNoAngleIsNoNumber) {
  EXPECT_TRUE(std::isnan(wrapAngle(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(wrapAngle(std::numeric_limits<double>::infinity())));
}

}  // namespace
}  // namespace lab
