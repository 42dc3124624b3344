/// Neighbour lists (Verlet lists), valid until a point has moved too far.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// Whether any point is farther than `distance` [m] from where it was; both in the same order.
[[nodiscard]] inline bool anyMoved(std::span<const Vec> points, std::span<const Vec> were,
                                   double distance) {
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double dx = points[i].x - were[i].x;
    const double dy = points[i].y - were[i].y;
    const double squared = dx * dx + dy * dy;
    farthest = squared > farthest ? squared : farthest;
  }
  return farthest > distance * distance;
}

/// All pairs of points closer than a cut-off, each pair listed at both ends (a Verlet list, built
/// from a grid of cells in time proportional to the number of points). The order of the neighbours
/// depends on the positions alone.
class NeighbourList {
 public:
  /// Lists the pairs closer than `cutoff` [m]. Points outside the arena are sorted into the cells
  /// at its edge.
  void build(std::span<const Vec> points, const Arena& arena, double cutoff);

  /// The neighbours of point i.
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const {
    return std::span(neighbours_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

 private:
  void sortIntoCells(std::span<const Vec> points, const Arena& arena, double cutoff);

  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::size_t> cell_of_;       ///< Per point.
  std::vector<std::uint32_t> cell_first_;  ///< Per cell, into members_.
  std::vector<std::uint32_t> members_;     ///< The points, cell by cell.
  std::vector<std::uint32_t> first_;       ///< Per point, into neighbours_.
  std::vector<std::uint32_t> neighbours_;
};

}  // namespace lab::sim
