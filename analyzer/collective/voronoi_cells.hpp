/// The Voronoi cells of a frame, clipped by the walls.
#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/collective/rectangle.hpp"

namespace lab::collective {

struct Point {
  double x = 0;  ///< [m]
  double y = 0;  ///< [m]
};

/// The points of the arena that are nearer to one robot than to any other.
struct VoronoiCell {
  double area = 0;                      ///< [m^2]
  bool at_wall = false;                 ///< a wall is a side of the cell
  std::vector<std::size_t> neighbours;  ///< robots whose cells share a side with this one
};

/// The cells of all points. A point outside of the rectangle counts as the nearest point on its
/// side; coinciding points are told apart by a step of 0.1 um. The areas add up to that of the
/// rectangle.
[[nodiscard]] std::vector<VoronoiCell> voronoiCells(const std::vector<Point>& points,
                                                    const Rectangle& arena);

/// |psi_6| of one point, psi_6 = mean of exp(6 i phi) over its neighbours at the angles phi
/// (Nelson and Halperin, Phys. Rev. B 19, 2457, 1979), as a complex number.
struct BondOrder {
  double real = 0;
  double imaginary = 0;
};
[[nodiscard]] BondOrder hexaticOf(const std::vector<Point>& points, std::size_t index,
                                  const VoronoiCell& cell);

}  // namespace lab::collective
