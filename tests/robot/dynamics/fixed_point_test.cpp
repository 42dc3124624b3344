#include "robot/dynamics/fixed_point.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace lab::dynamics {
namespace {

double real(Fixed x) { return x / static_cast<double>(kOne); }

/// Numbers of all sizes, and the limits.
std::vector<Fixed> manyNumbers() {
  std::vector<Fixed> numbers{0, 1, -1, kOne, -kOne, kLargest, kSmallest, kLargest - 1, kFixedPi};
  std::mt19937 rng(1);
  for (int i = 0; i < 400; ++i) {
    const Fixed x = static_cast<Fixed>(rng() >> (rng() % 31)) & kLargest;
    numbers.push_back(x);
    numbers.push_back(-x);
  }
  return numbers;
}

/// The exact result, rounded to the nearest number and limited.
void expectRounded(long double exact, Fixed got, bool saturated, const char* what, Fixed a,
                   Fixed b) {
  const long double scaled = exact * kOne;
  if (scaled > kLargest + 0.5L || scaled < kSmallest - 0.5L) {
    EXPECT_TRUE(saturated) << what << ' ' << a << ' ' << b;
    EXPECT_EQ(got, scaled > 0 ? kLargest : kSmallest) << what << ' ' << a << ' ' << b;
  } else {
    EXPECT_LE(std::abs(scaled - got), 0.5000001L) << what << ' ' << a << ' ' << b;
  }
}

TEST(FixedPoint, ArithmeticIsRoundedAndSaturates) {
  const std::vector<Fixed> numbers = manyNumbers();
  for (const Fixed a : numbers) {
    for (const Fixed b : numbers) {
      const long double x = a / static_cast<long double>(kOne);
      const long double y = b / static_cast<long double>(kOne);
      const auto expectResult = [&](Fixed (*operation)(Fixed, Fixed, bool&), long double exact,
                                    const char* what) {
        bool saturated = false;
        const Fixed got = operation(a, b, saturated);
        expectRounded(exact, got, saturated, what, a, b);
      };
      expectResult(addFixed, x + y, "+");
      expectResult(subtractFixed, x - y, "-");
      expectResult(multiplyFixed, x * y, "*");
      if (b != 0) {
        expectResult(divideFixed, x / y, "/");
      }
    }
  }
}

TEST(FixedPoint, DivisionByZeroGivesALimitAndSaysSo) {
  bool saturated = false;
  EXPECT_EQ(divideFixed(5, 0, saturated), kLargest);
  EXPECT_TRUE(saturated);
  EXPECT_EQ(divideFixed(-5, 0, saturated), kSmallest);
  EXPECT_EQ(divideFixed(0, 0, saturated), 0);
}

TEST(FixedPoint, SquareRootIsExactRoundedDown) {
  for (const Fixed x : manyNumbers()) {
    bool saturated = false;
    const Fixed root = sqrtFixed(x, saturated);
    EXPECT_EQ(saturated, x < 0);
    if (x >= 0) {
      const auto square = static_cast<uint64_t>(root) * static_cast<uint64_t>(root);
      const auto above = static_cast<uint64_t>(root + 1) * static_cast<uint64_t>(root + 1);
      const auto wanted = static_cast<uint64_t>(x) << kFractionBits;
      EXPECT_TRUE(square <= wanted && wanted < above) << x;
    }
  }
}

TEST(FixedPoint, SineAndCosineAreRightWithinTwoUnits) {
  double worst = 0;
  for (uint64_t turns = 0; turns < 1ULL << 32; turns += 65521) {
    const double angle = static_cast<double>(turns) * 2 * std::numbers::pi / 4294967296.0;
    worst =
        std::max(worst, std::abs(real(sinTurns(static_cast<uint32_t>(turns))) - std::sin(angle)));
    worst =
        std::max(worst, std::abs(real(cosTurns(static_cast<uint32_t>(turns))) - std::cos(angle)));
  }
  EXPECT_LT(worst, 2e-5);
  EXPECT_EQ(sinTurns(0), 0);
  EXPECT_EQ(cosTurns(0), kOne);
  EXPECT_EQ(sinTurns(0x80000000U), 0);
}

TEST(FixedPoint, AnglesBecomeTurnsAndBack) {
  for (double angle = -30000; angle < 30000; angle += 7.7773) {
    const Fixed radians = static_cast<Fixed>(std::lround(angle * kOne));
    const double exact = std::remainder(real(radians), 2 * std::numbers::pi);
    const double got = real(radiansOf(turnsOf(radians)));
    EXPECT_LT(std::abs(std::remainder(got - exact, 2 * std::numbers::pi)), 3e-5) << angle;
  }
  EXPECT_EQ(radiansOf(0x80000000U), kFixedPi);
}

TEST(FixedPoint, Atan2IsRightWithinFourInAHundredThousand) {
  const std::vector<Fixed> numbers = manyNumbers();
  for (const Fixed y : numbers) {
    for (const Fixed x : numbers) {
      const double exact = std::atan2(real(y), real(x));
      const double got = real(atan2Fixed(y, x));
      EXPECT_LT(std::abs(std::remainder(got - exact, 2 * std::numbers::pi)), 4e-5) << y << ' ' << x;
    }
  }
}

TEST(FixedPoint, PowersOfTwoAreRight) {
  for (uint32_t exponent = 0; exponent < 15U << kFractionBits; exponent += 37) {
    bool saturated = false;
    const double exact = std::exp2(exponent / static_cast<double>(kOne));
    const double got = real(exp2Fixed(exponent, saturated));
    EXPECT_LT(std::abs(got - exact), 2e-5 * exact) << exponent;
    EXPECT_FALSE(saturated);
  }
  bool saturated = false;
  EXPECT_EQ(exp2Fixed(15U << kFractionBits, saturated), kLargest);
  EXPECT_TRUE(saturated);
}

}  // namespace
}  // namespace lab::dynamics
