/// Areas inside the arena, for corrections at its walls.
#pragma once

#include <algorithm>

namespace lab::collective {

/// A rectangle parallel to the axes [m].
struct Rectangle {
  double left = 0;
  double bottom = 0;
  double right = 0;
  double top = 0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return top - bottom; }
  [[nodiscard]] double area() const { return width() * height(); }
  [[nodiscard]] double nearestX(double x) const { return std::clamp(x, left, right); }
  [[nodiscard]] double nearestY(double y) const { return std::clamp(y, bottom, top); }

  /// The rectangle without a margin along its sides. A margin of half a side or more leaves the
  /// centre line.
  [[nodiscard]] Rectangle shrunk(double margin) const {
    const double x = std::min(margin, 0.5 * width());
    const double y = std::min(margin, 0.5 * height());
    return {left + x, bottom + y, right - x, top - y};
  }
};

/// The area of the part of a disc that lies inside the rectangle [m^2], exact.
/// @param x, y centre of the disc, inside the rectangle [m]
[[nodiscard]] double discAreaInside(double x, double y, double radius, const Rectangle& rectangle);

/// The same for any centre.
[[nodiscard]] double discAreaIn(double x, double y, double radius, const Rectangle& rectangle);

}  // namespace lab::collective
