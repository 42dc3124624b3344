#include "robot/dynamics/fixed_point.hpp"

#include "robot/dynamics/flash.hpp"

// The chip has 8 bits: 64-bit products are unavoidable, but 64-bit quotients, shifts and loops
// would cost it thousands of cycles. So they are written in 32-bit steps.

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

/// The product without its lowest 31 bits.
uint32_t withoutLow31(uint64_t product) {
  return static_cast<uint32_t>(product >> 32) << 1 | static_cast<uint32_t>(product) >> 31;
}

/// x y for x and y in units of 2^-31.
uint32_t product31(uint32_t x, uint32_t y) { return withoutLow31(static_cast<uint64_t>(x) * y); }

/// part * 2^bits / whole, rounded down, and what remains; part and whole are below 2^31, whole is
/// not 0, and the quotient is below 2^32. A host has an instruction for this, the chip has not.
uint32_t shiftedQuotient(uint32_t part, uint8_t bits, uint32_t whole, uint32_t& rest) {
#ifdef __AVR__
  uint32_t quotient = part / whole;
  rest = part % whole;
  for (uint8_t i = 0; i < bits; ++i) {
    rest <<= 1;
    quotient <<= 1;
    if (rest >= whole) {
      rest -= whole;
      quotient |= 1U;
    }
  }
  return quotient;
#else
  const uint64_t dividend = static_cast<uint64_t>(part) << bits;
  rest = static_cast<uint32_t>(dividend % whole);
  return static_cast<uint32_t>(dividend / whole);
#endif
}

// Least maximum errors over [0, 1], fitted to sin(pi x / 2) / x, arctan(x) / x and (2^x - 1) / x
// as polynomials in x squared, x squared and x; largest errors 6e-7, 1.7e-6 and 1.2e-7.
const int32_t kSine[4] LAB_IN_FLASH = {1686624005L, -693522166L, 85291978L, -4652626L};
const int32_t kArcTangent[6] LAB_IN_FLASH = {1073717364L, -357151047L, 207812427L,
                                             -125012034L, 56529703L,   -12583343L};
const int32_t kExponential[5] LAB_IN_FLASH = {744266799L, 257862114L, 59953370L, 9635092L,
                                              2024323L};

/// The polynomial sum of c[i] x^i, with x in [0, 1] in units of 2^-31 and coefficients and result
/// in units of 2^-30 (Horner's rule).
int32_t polynomial(const int32_t* coefficients, uint8_t size, uint32_t x) {
  int32_t sum = readFlash(&coefficients[size - 1]);
  for (uint8_t i = static_cast<uint8_t>(size - 1); i > 0; --i) {
    const uint64_t product =
        static_cast<uint64_t>(static_cast<int64_t>(sum) * static_cast<int64_t>(x));
    sum = readFlash(&coefficients[i - 1]) + static_cast<int32_t>(withoutLow31(product));
  }
  return sum;
}

constexpr uint32_t kTurnsPerRadian = 683565276UL;  // 2^32 / (2 pi)

/// arctan(smaller / larger) in units of 2^-32 turns; larger is above 0.
uint32_t arcTangentTurns(uint32_t smaller, uint32_t larger) {
  uint32_t rest = 0;
  const uint32_t ratio = shiftedQuotient(smaller, 31, larger, rest);
  const uint32_t slope = static_cast<uint32_t>(polynomial(kArcTangent, 6, product31(ratio, ratio)));
  const uint32_t radians = product31(ratio, slope);
  return static_cast<uint32_t>((static_cast<uint64_t>(radians) * kTurnsPerRadian) >> 30);
}

}  // namespace

// A sum overflows if both summands have the same sign and it has the other one. The 32-bit sum may
// also be the one number below kSmallest.
Fixed addFixed(Fixed a, Fixed b, bool& saturated) {
  const Fixed sum = static_cast<Fixed>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
  if (((a ^ sum) & (b ^ sum)) < 0 || sum < kSmallest) {
    saturated = true;
    return a < 0 ? kSmallest : kLargest;
  }
  return sum;
}

Fixed subtractFixed(Fixed a, Fixed b, bool& saturated) { return addFixed(a, -b, saturated); }

Fixed multiplyFixed(Fixed a, Fixed b, bool& saturated) {
  return limited((static_cast<int64_t>(a) * b + 0x8000L) >> kFractionBits, saturated);
}

Fixed divideFixed(Fixed a, Fixed b, bool& saturated) {
  if (b == 0) {
    saturated = true;
    return a > 0 ? kLargest : a < 0 ? kSmallest : 0;
  }
  const uint32_t divisor = absoluteValue(b);
  const uint32_t dividend = absoluteValue(a);
  const bool negative = (a < 0) != (b < 0);
  if (dividend >> 15 >= divisor) {
    saturated = true;
    return negative ? kSmallest : kLargest;
  }
  uint32_t rest = 0;
  uint32_t quotient = shiftedQuotient(dividend, kFractionBits, divisor, rest);
  quotient += rest >= divisor - divisor / 2U ? 1U : 0U;
  if (quotient > static_cast<uint32_t>(kLargest)) {
    saturated = true;
    quotient = static_cast<uint32_t>(kLargest);
  }
  return negative ? -static_cast<Fixed>(quotient) : static_cast<Fixed>(quotient);
}

Fixed sqrtFixed(Fixed x, bool& saturated) {
  if (x < 0) {
    saturated = true;
    return 0;
  }
  // Digit by digit: two bits of x for each bit of the root, then 8 pairs of zeros.
  uint32_t digits = static_cast<uint32_t>(x);
  uint32_t rest = 0;
  uint32_t root = 0;
  for (uint8_t i = 0; i < 24; ++i) {
    rest = rest << 2 | digits >> 30;
    digits <<= 2;
    const uint32_t trial = root << 2 | 1U;
    const bool fits = rest >= trial;
    rest -= fits ? trial : 0U;
    root = root << 1 | (fits ? 1U : 0U);
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
  const uint32_t slope = static_cast<uint32_t>(polynomial(kSine, 4, product31(x, x)));
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
  const uint32_t part = static_cast<uint32_t>(exponent & 0xFFFFUL) << 15;  // in units of 2^-31
  const uint32_t slope = static_cast<uint32_t>(polynomial(kExponential, 5, part));
  // 2^part in units of 2^-31: 1 + part * slope, below 2.
  const uint64_t rise = (static_cast<uint64_t>(part) * slope) >> 30;
  const uint64_t power = (1ULL << 31) + rise;
  const uint8_t shift = static_cast<uint8_t>(15 - whole);
  return static_cast<Fixed>((power + (1ULL << (shift - 1))) >> shift);
}

}  // namespace dynamics
}  // namespace lab
