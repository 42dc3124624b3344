#include "analyzer/collective/rectangle.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace lab::collective {
namespace {

using std::numbers::pi;

/// The area of the part of a disc beyond a line at this distance from its centre.
double segmentArea(double distance, double radius) {
  if (distance >= radius) return 0;
  if (distance <= -radius) return pi * radius * radius;
  return radius * radius * std::acos(distance / radius) -
         distance * std::sqrt(radius * radius - distance * distance);
}

}  // namespace

double discAreaInside(double x, double y, double radius, const Rectangle& rectangle) {
  const double whole = pi * radius * radius;
  // Distances from the walls, in the order in which the walls meet.
  const std::array<double, 4> distances{x - rectangle.left, y - rectangle.bottom,
                                        rectangle.right - x, rectangle.top - y};
  if (*std::min_element(distances.begin(), distances.end()) >= radius) return whole;
  std::array<double, 4> beyond{};
  double area = whole;
  for (std::size_t i = 0; i < 4; ++i) {
    beyond[i] = segmentArea(distances[i], radius);
    area -= beyond[i];
  }
  // What lies beyond two walls was subtracted twice.
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const double a = distances[i];
    const double b = distances[next];
    if (a * a + b * b < radius * radius) {
      area += 0.5 * (beyond[i] + beyond[next]) + a * b - 0.25 * whole;
    }
  }
  return std::max(0.0, area);
}

double discAreaIn(double x, double y, double radius, const Rectangle& rectangle) {
  const double radius2 = radius * radius;
  // The part of the disc around the origin with u <= a and v <= b.
  const auto quadrant = [&](double a, double b) {
    const double below_a = segmentArea(-a, radius);
    const double below_b = segmentArea(-b, radius);
    if (a * a + b * b < radius2) return 0.5 * (below_a + below_b) + a * b - 0.25 * pi * radius2;
    if (a <= 0 && b <= 0) return 0.0;
    if (a <= 0) return below_a;
    if (b <= 0) return below_b;
    return below_a + below_b - pi * radius2;
  };
  const double left = rectangle.left - x;
  const double right = rectangle.right - x;
  const double bottom = rectangle.bottom - y;
  const double top = rectangle.top - y;
  if (left >= radius || right <= -radius || bottom >= radius || top <= -radius) return 0;
  const double area =
      quadrant(right, top) - quadrant(left, top) - quadrant(right, bottom) + quadrant(left, bottom);
  return std::max(0.0, area);
}

}  // namespace lab::collective
