/// The simulated arena and its light.
#pragma once

namespace lab::sim {

/// A rectangle with hard walls: 0 <= x <= width, 0 <= y <= height, in metres.
struct Arena {
  double width = 1.20;
  double height = 0.90;
};

/// A point or a vector in the arena, in metres.
struct Vec {
  double x = 0;
  double y = 0;
};

/// The light on the arena as the simulated sensors see it.
class LightSampler {
 public:
  virtual ~LightSampler() = default;

  /// Intensity at (x, y) in metres: 0 dark .. 1 projector white.
  [[nodiscard]] virtual double at(double x, double y) const = 0;
};

}  // namespace lab::sim
