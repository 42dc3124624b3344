#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// -ln(U) in units of 2^-16, where U = (bits | 1) / 2^32 is in (0, 1). Absolute error below 3e-5
/// (table of 128 logarithms, linear interpolation); the largest value is 32 ln 2 = 22.2.
uint32_t negativeLog(uint32_t bits);

/// -log2(U) in units of 2^-16, for the same U.
uint32_t negativeLog2(uint32_t bits);

}  // namespace dynamics
}  // namespace lab
