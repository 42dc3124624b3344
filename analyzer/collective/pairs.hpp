/// Pairs of points within a distance, and clusters of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "analyzer/collective/voronoi_cells.hpp"

namespace lab::collective {

/// Calls visit(i, j, dx, dy, distance squared) once for each pair closer than `distance` [m], with
/// the vector from i to j. Sorts by x, which is fast enough for some thousand robots.
/// @param order kept between calls to reuse its memory, and its order
template <class Visit>
void forEachPair(const std::vector<Point>& points, double distance, std::vector<std::size_t>& order,
                 Visit visit) {
  if (order.size() != points.size()) {
    order.resize(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].x != points[b].x ? points[a].x < points[b].x : a < b;
  });
  const double distance2 = distance * distance;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const Point& from = points[order[a]];
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const Point& to = points[order[b]];
      const double dx = to.x - from.x;
      if (dx >= distance) break;
      const double dy = to.y - from.y;
      const double r2 = dx * dx + dy * dy;
      if (r2 < distance2) visit(order[a], order[b], dx, dy, r2);
    }
  }
}

/// Joins points to clusters (union-find).
class Clusters {
 public:
  /// Forgets all joins.
  void reset(std::size_t points) {
    parent_.resize(points);
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    // The smaller index is the root, so that the result does not depend on the order.
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

  /// The smallest index in the cluster of this point.
  [[nodiscard]] std::size_t root(std::size_t a) {
    while (parent_[a] != a) {
      parent_[a] = parent_[parent_[a]];
      a = parent_[a];
    }
    return a;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace lab::collective
