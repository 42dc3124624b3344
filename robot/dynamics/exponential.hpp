#pragma once

#include <stdint.h>

#include "robot/dynamics/rng.hpp"

namespace lab {
namespace dynamics {

/// -ln(U) in units of 2^-16, where U = (bits | 1) / 2^32 is in (0, 1). Absolute error below 3e-5
/// (log table of 128 entries, linear between them); the largest value is 32 ln 2 = 22.2.
uint32_t negativeLog(uint32_t bits);

/// An exponentially distributed time of the given mean, rounded to the NEAREST millisecond, so that
/// its mean is the mean asked for (rounding up would add half a millisecond to every run). It may
/// be 0. The mean is in microseconds, at most kLongestMeanUs.
uint32_t exponentialMs(Rng& rng, uint32_t mean_us);

/// The longest mean of exponentialMs: 100 s, so that the longest draw still fits in 32 bits.
constexpr uint32_t kLongestMeanUs = 100000000UL;

}  // namespace dynamics
}  // namespace lab
