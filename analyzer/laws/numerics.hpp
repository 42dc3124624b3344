#pragma once

#include <cmath>

namespace lab::analysis {

/// x, or 0 if x is not finite.
inline double finiteOrZero(double x) { return std::isfinite(x) ? x : 0; }

/// The deviation of a mean square from what is expected, of which `ratio` is the multiple: nearly
/// normal, and nearly ratio - 1 where the ratio is nearly 1 (Wilson and Hilferty).
inline double normalised(double ratio) { return 3 * (std::cbrt(ratio) - 1); }

/// sin(x) / x.
inline double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }

}  // namespace lab::analysis
