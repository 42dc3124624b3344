#pragma once

#include <stdint.h>

#include "robot/dynamics/rng.hpp"

namespace lab {
namespace dynamics {

/// -ln(U) in units of 2^-16, where U = (bits | 1) / 2^32 is in (0, 1). Absolute error below 3e-5
/// (table of 128 logarithms, linear interpolation); the largest value is 32 ln 2 = 22.2.
uint32_t negativeLog(uint32_t bits);

/// -log2(U) in units of 2^-16, for the same U.
uint32_t negativeLog2(uint32_t bits);

/// An exponentially distributed time with the given mean (microseconds, at most kLongestMeanUs),
/// rounded to the nearest millisecond, which may be 0. Rounding up would lengthen every run by half
/// a millisecond on average.
uint32_t exponentialMs(Rng& rng, uint32_t mean_us);

/// The longest mean of exponentialMs: 100 s, so that the longest draw still fits in 32 bits.
constexpr uint32_t kLongestMeanUs = 100000000UL;

}  // namespace dynamics
}  // namespace lab
