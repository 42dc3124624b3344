/// The simulated arena and its light.
#pragma once

#include <cstddef>

namespace lab::sim {

/// A rectangle with hard walls: 0 <= x <= width, 0 <= y <= height [m].
struct Arena {
  double width = 1.20;
  double height = 0.90;
};

/// A point or a vector in the arena [m].
struct Vec {
  double x = 0;
  double y = 0;
};

/// The light on the arena, for the simulated sensors.
class LightSampler {
 public:
  virtual ~LightSampler() = default;

  /// Intensity at (x, y) [m]: 0 dark .. 1 projector white.
  [[nodiscard]] virtual double at(double x, double y) const = 0;

  /// Intensities at `count` places (x[i], y[i]): the same numbers as of at(). Several threads may
  /// call it at the same time.
  virtual void atPlaces(const double* x, const double* y, std::size_t count, double* out) const {
    for (std::size_t i = 0; i < count; ++i) out[i] = at(x[i], y[i]);
  }
};

}  // namespace lab::sim
