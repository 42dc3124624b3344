/// Cells of half a pixel, in which the simulated camera is painted before the lens blurs them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "light/field/target_clones.hpp"

namespace lab::sim::painter {

/// The rectangle x0 <= x < x1, y0 <= y < y1, in pixels or cells.
struct Box {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] Box grown(int by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
  [[nodiscard]] Box within(const Box& other) const {
    return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1),
            std::min(y1, other.y1)};
  }
};

/// The lattice of cells: 2 x 2 per pixel, with a margin of whole pixels around the picture.
/// Cell (i, j) has its centre at pixel coordinate i / 2 - margin - 1/4.
struct Lattice {
  int width = 0;   ///< [px] picture
  int height = 0;  ///< [px] picture
  int margin = 0;  ///< [px]

  [[nodiscard]] int columns() const { return 2 * (width + 2 * margin); }
  [[nodiscard]] int rows() const { return 2 * (height + 2 * margin); }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows());
  }
  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns()) +
           static_cast<std::size_t>(i);
  }
  [[nodiscard]] double pixel(int cell) const { return 0.5 * cell - margin - 0.25; }
  [[nodiscard]] Box picture() const { return {0, 0, width, height}; }
  [[nodiscard]] Box all() const { return {0, 0, columns(), rows()}; }

  /// The cells of these pixels.
  [[nodiscard]] Box cells(const Box& pixels) const {
    return {2 * (pixels.x0 + margin), 2 * (pixels.y0 + margin), 2 * (pixels.x1 + margin),
            2 * (pixels.y1 + margin)};
  }
};

/// The share of a cell that a shape with a straight edge covers. `inside` [m] is the distance from
/// the edge to the cell's centre, positive if the centre is inside the shape; a and b are the
/// widths of the cell's two sides across the edge, m that of the shape's motion during the
/// exposure. The result is the integral of the convolution of three boxes. It is exact for the
/// cell, so that the lattice leaves no pattern in the picture.
inline float coverOf(float inside, float a, float b, float m) {
  constexpr float kLeast = 0.05F;  // of the widest box: avoids a division by zero
  const float widest = (a > b ? a : b) > m ? (a > b ? a : b) : m;
  const float least = kLeast * widest;
  a = a > least ? a : least;
  b = b > least ? b : least;
  m = m > least ? m : least;
  const float whole = a + b + m;
  const float per_whole = 1.0F / whole;
  a *= per_whole;
  b *= per_whole;
  m *= per_whole;
  float t = inside * per_whole;
  t = t > -0.5F ? t : -0.5F;
  t = t < 0.5F ? t : 0.5F;
  // By symmetry, the sum is computed on the less covered side, where it is more accurate.
  const float from = 0.5F - (t < 0.0F ? -t : t);  // distance from the end of the edge
  const auto cube = [](float x) {
    x = x > 0.0F ? x : 0.0F;
    return x * x * x;
  };
  const float sum = cube(from) - cube(from - a) - cube(from - b) - cube(from - m) +
                    cube(from - a - b) + cube(from - a - m) + cube(from - b - m);
  const float part = sum / (6.0F * a * b * m);
  return t < 0.0F ? part : 1.0F - part;
}

/// The point spread function: the Gaussian blur of the lens, convolved with the pixel's square.
class PointSpread {
 public:
  /// @param blur [px] standard deviation of the Gaussian
  explicit PointSpread(double blur);

  /// The distance from a cell's own pixel to the last pixel that it affects [px].
  [[nodiscard]] int reach() const { return reach_; }

  /// Computes the pixels of `box` in `out` (rows of lattice.width) from the cells of the lattice.
  void apply(const Lattice& lattice, const float* cells, const Box& box, float* out);

 private:
  int reach_ = 0;
  std::vector<float> taps_;  ///< weights of the cells on one side, the nearest first
  std::vector<float> column_;
  std::vector<float> even_;
  std::vector<float> odd_;
};

}  // namespace lab::sim::painter
