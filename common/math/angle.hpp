/// Angles.
#pragma once

#include <cmath>
#include <numbers>

namespace lab {

/// The angle [rad], wrapped to [-pi, pi]. Equal to std::remainder(angle, 2 * pi) to the bit, and
/// faster within +-3 pi.
inline double wrapAngle(double angle) {
  constexpr double kTurn = 2 * std::numbers::pi;
  constexpr double kHalf = std::numbers::pi;
  if (std::abs(angle) <= kHalf) return angle;
  // The difference is exact: the operands differ by less than a factor of 2 (Sterbenz).
  if (std::abs(angle) < 3 * kHalf) return angle - std::copysign(kTurn, angle);
  return std::remainder(angle, kTurn);
}

}  // namespace lab
