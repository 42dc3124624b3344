#include "robot/dynamics/fixed_point.hpp"

namespace lab {
namespace dynamics {
namespace {

Fixed limited(int64_t value, bool& saturated) {
  if (value > kLargest) {
    saturated = true;
    return kLargest;
  }
  if (value < kSmallest) {
    saturated = true;
    return kSmallest;
  }
  return static_cast<Fixed>(value);
}

uint32_t absoluteValue(Fixed a) {
  return a < 0 ? 0U - static_cast<uint32_t>(a) : static_cast<uint32_t>(a);
}

/// The polynomial sum of c[i] x^i, with x in [0, 1] in units of 2^-31 and coefficients and result
/// in units of 2^-30 (Horner's rule).
template <uint8_t kSize>
int32_t polynomial(const int32_t (&coefficients)[kSize], uint32_t x) {
  int32_t sum = coefficients[kSize - 1];
  for (uint8_t i = kSize - 1; i > 0; --i) {
    sum = coefficients[i - 1] +
          static_cast<int32_t>((static_cast<int64_t>(sum) * static_cast<int64_t>(x)) >> 31);
  }
  return sum;
}

// Least maximum errors over [0, 1], fitted to sin(pi x / 2) / x, arctan(x) / x and (2^x - 1) / x
// as polynomials in x squared, x squared and x; largest errors 6e-7, 1.7e-6 and 1.2e-7.
constexpr int32_t kSine[4] = {1686624005L, -693522166L, 85291978L, -4652626L};
constexpr int32_t kArcTangent[6] = {1073717364L, -357151047L, 207812427L,
                                    -125012034L, 56529703L,   -12583343L};
constexpr int32_t kExponential[5] = {744266799L, 257862114L, 59953370L, 9635092L, 2024323L};

constexpr uint32_t kTurnsPerRadian = 683565276UL;  // 2^32 / (2 pi)

/// x squared for x in [0, 1], both in units of 2^-31.
uint32_t squared(uint32_t x) { return static_cast<uint32_t>((static_cast<uint64_t>(x) * x) >> 31); }

/// arctan(smaller / larger) in units of 2^-32 turns; larger is above 0.
uint32_t arcTangentTurns(uint32_t smaller, uint32_t larger) {
  const uint32_t ratio = static_cast<uint32_t>((static_cast<uint64_t>(smaller) << 31) / larger);
  const uint32_t slope = static_cast<uint32_t>(polynomial(kArcTangent, squared(ratio)));
  const uint32_t radians = static_cast<uint32_t>((static_cast<uint64_t>(ratio) * slope) >> 31);
  return static_cast<uint32_t>((static_cast<uint64_t>(radians) * kTurnsPerRadian) >> 30);
}

}  // namespace

Fixed addFixed(Fixed a, Fixed b, bool& saturated) {
  return limited(static_cast<int64_t>(a) + b, saturated);
}

Fixed subtractFixed(Fixed a, Fixed b, bool& saturated) {
  return limited(static_cast<int64_t>(a) - b, saturated);
}

Fixed multiplyFixed(Fixed a, Fixed b, bool& saturated) {
  return limited((static_cast<int64_t>(a) * b + 0x8000L) >> kFractionBits, saturated);
}

Fixed divideFixed(Fixed a, Fixed b, bool& saturated) {
  if (b == 0) {
    saturated = true;
    return a > 0 ? kLargest : a < 0 ? kSmallest : 0;
  }
  const uint32_t divisor = absoluteValue(b);
  const uint64_t quotient =
      ((static_cast<uint64_t>(absoluteValue(a)) << kFractionBits) + divisor / 2U) / divisor;
  const int64_t size = static_cast<int64_t>(quotient);
  return limited((a < 0) == (b < 0) ? size : -size, saturated);
}

Fixed sqrtFixed(Fixed x, bool& saturated) {
  if (x < 0) {
    saturated = true;
    return 0;
  }
  uint64_t rest = static_cast<uint64_t>(x) << kFractionBits;
  uint64_t root = 0;
  for (uint64_t bit = 1ULL << 46; bit != 0; bit >>= 2) {
    if (rest >= root + bit) {
      rest -= root + bit;
      root = (root >> 1) + bit;
    } else {
      root >>= 1;
    }
  }
  return static_cast<Fixed>(root);
}

uint32_t turnsOf(Fixed radians) {
  constexpr int64_t kTurns = 2734261102LL;  // 2^34 / (2 pi)
  const uint64_t product = static_cast<uint64_t>(static_cast<int64_t>(radians) * kTurns);
  return static_cast<uint32_t>(product >> 18);
}

Fixed radiansOf(uint32_t turns) {
  const int32_t half_turns = static_cast<int32_t>(turns);  // [-pi, pi) in units of 2^-31 pi
  const Fixed radians =
      static_cast<Fixed>((static_cast<int64_t>(half_turns) * kFixedPi + 0x40000000L) >> 31);
  return radians == -kFixedPi ? kFixedPi : radians;
}

Fixed sinTurns(uint32_t turns) {
  const bool negative = (turns & 0x80000000UL) != 0;
  uint32_t quarter = turns & 0x7FFFFFFFUL;  // [0, pi) in units of 2^-31 pi
  if (quarter > 0x40000000UL) {
    quarter = 0x80000000UL - quarter;
  }
  const uint32_t x = quarter << 1;  // [0, pi / 2] in units of 2^-31 pi / 2
  const uint32_t slope = static_cast<uint32_t>(polynomial(kSine, squared(x)));
  const uint32_t sine =
      static_cast<uint32_t>((static_cast<uint64_t>(x) * slope + (1ULL << 44)) >> 45);
  return negative ? -static_cast<Fixed>(sine) : static_cast<Fixed>(sine);
}

Fixed atan2Fixed(Fixed y, Fixed x) {
  const uint32_t width = absoluteValue(x);
  const uint32_t height = absoluteValue(y);
  if (width == 0 && height == 0) {
    return 0;
  }
  uint32_t turns = height <= width ? arcTangentTurns(height, width)
                                   : 0x40000000UL - arcTangentTurns(width, height);
  if (x < 0) {
    turns = 0x80000000UL - turns;
  }
  return radiansOf(y < 0 ? 0U - turns : turns);
}

Fixed exp2Fixed(uint32_t exponent, bool& saturated) {
  const uint32_t whole = exponent >> kFractionBits;
  if (whole >= 15) {
    saturated = true;
    return kLargest;
  }
  const uint32_t part = (exponent & 0xFFFFUL) << 15;  // in units of 2^-31
  const uint32_t slope = static_cast<uint32_t>(polynomial(kExponential, part));
  // 2^part in units of 2^-31: 1 + part * slope, below 2.
  const uint64_t rise = (static_cast<uint64_t>(part) * slope) >> 30;
  const uint64_t power = (1ULL << 31) + rise;
  const uint8_t shift = static_cast<uint8_t>(15 - whole);
  return static_cast<Fixed>((power + (1ULL << (shift - 1))) >> shift);
}

}  // namespace dynamics
}  // namespace lab
