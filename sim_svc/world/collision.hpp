/// Moves of hard disks that stop at contact with disks or walls.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// Robots keep this much apart, so that rounding never makes them overlap.
inline constexpr double kContactGap = 1e-9;  // [m]

/// The share (0..1) of a straight move that a disk can make before its centre comes within
/// `distance` of another centre. 1 for a move that does not approach, so that touching disks can
/// separate.
/// @param to_other from the moving centre to the other one, at the start of the move
/// @param squared_distance the square of the contact distance [m^2]
[[nodiscard]] inline double freeShareToDisk(Vec to_other, Vec move, double squared_distance) {
  const double approach = to_other.x * move.x + to_other.y * move.y;
  if (approach <= 0) {
    return 1;
  }
  const double gap = to_other.x * to_other.x + to_other.y * to_other.y - squared_distance;
  if (gap <= 0) {
    return 0;
  }
  const double length = move.x * move.x + move.y * move.y;
  const double discriminant = approach * approach - length * gap;
  if (discriminant < 0) {
    return 1;
  }
  // The smaller root of length s^2 - 2 approach s + gap = 0, without cancellation.
  return std::min(1.0, gap / (approach + std::sqrt(discriminant)));
}

/// The share (0..1) of a move along one axis that stays between the limits low and high.
[[nodiscard]] inline double freeShareOnAxis(double from, double move, double low, double high) {
  if (from + move > high && move > 0) {
    return std::max(0.0, (high - from) / move);
  }
  if (from + move < low && move < 0) {
    return std::max(0.0, (low - from) / move);
  }
  return 1;
}

/// The share (0..1) of a straight move that a disk of the given radius can make inside the arena.
[[nodiscard]] inline double freeShareToWalls(const Arena& arena, double radius, Vec from,
                                             Vec move) {
  return std::min(freeShareOnAxis(from.x, move.x, radius, arena.width - radius),
                  freeShareOnAxis(from.y, move.y, radius, arena.height - radius));
}

}  // namespace lab::sim
