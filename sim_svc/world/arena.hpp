/// The simulated arena and its light.
#pragma once

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
};

}  // namespace lab::sim
