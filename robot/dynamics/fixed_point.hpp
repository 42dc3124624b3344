#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// A number of a program: 32-bit fixed point with 16 fractional bits, in centimetres, seconds,
/// radians and their products. Largest value 32768, resolution 1.5e-5: a wheel speed resolves
/// 0.15 um/s, a squared length reaches 1.8 m squared.
using Fixed = int32_t;

constexpr uint8_t kFractionBits = 16;
constexpr Fixed kOne = 65536L;
constexpr Fixed kLargest = 0x7FFFFFFFL;
/// The smallest number is -kLargest, so that every number has its negative.
constexpr Fixed kSmallest = -kLargest;
constexpr Fixed kFixedPi = 205887L;  ///< pi, rounded to the nearest number

/// Arithmetic that saturates at the largest number instead of overflowing. A division by zero gives
/// the largest number of the sign of the dividend, and 0 / 0 gives 0. Every saturation sets
/// `saturated`; no operation clears it. Products and quotients are rounded to the nearest number,
/// halves towards positive.
Fixed addFixed(Fixed a, Fixed b, bool& saturated);
Fixed subtractFixed(Fixed a, Fixed b, bool& saturated);
Fixed multiplyFixed(Fixed a, Fixed b, bool& saturated);
Fixed divideFixed(Fixed a, Fixed b, bool& saturated);

/// The square root, rounded down. A negative argument gives 0 and sets `saturated`.
Fixed sqrtFixed(Fixed x, bool& saturated);

/// An angle as a part of a turn in units of 2^-32, which wraps around.
uint32_t turnsOf(Fixed radians);

/// The angle in (-pi, pi] [rad] of a part of a turn.
Fixed radiansOf(uint32_t turns);

/// Sine and cosine of a part of a turn, absolute error below 2e-5.
Fixed sinTurns(uint32_t turns);
inline Fixed cosTurns(uint32_t turns) { return sinTurns(turns + 0x40000000UL); }

/// The angle of the point (x, y) in (-pi, pi] [rad], absolute error below 4e-5; 0 at the origin.
Fixed atan2Fixed(Fixed y, Fixed x);

/// 2^(exponent / 65536) as a fixed-point number, relative error below 2e-5 and half a unit of the
/// last place. Saturates above 2^15.
Fixed exp2Fixed(uint32_t exponent, bool& saturated);

}  // namespace dynamics
}  // namespace lab
