#include "analyzer/collective/voronoi_cells.hpp"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

namespace lab::collective {
namespace {

// The diagram is computed exactly for integers of 32 bits.
constexpr double kFinestPerMetre = 1e7;
constexpr double kMostSteps = 1e9;
constexpr std::size_t kWall = std::numeric_limits<std::size_t>::max();
// Sides shorter than this share of the arena's width are corners at which four cells meet.
constexpr double kShortestSide = 1e-7;

/// A corner of a cell, and whose side begins there.
struct Corner {
  double x;
  double y;
  std::size_t beyond;  ///< the robot on the other side, or kWall
};

/// Clips a convex polygon, counter-clockwise, by the points that are nearer to a than to b.
void clip(std::vector<Corner>& cell, std::vector<Corner>& scratch, const Point& a, const Point& b,
          std::size_t index_b) {
  const double nx = b.x - a.x;
  const double ny = b.y - a.y;
  const double limit = 0.5 * (nx * (a.x + b.x) + ny * (a.y + b.y));
  scratch.clear();
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const Corner& from = cell[i];
    const Corner& to = cell[(i + 1) % cell.size()];
    const double d_from = nx * from.x + ny * from.y - limit;
    const double d_to = nx * to.x + ny * to.y - limit;
    if (d_from <= 0) scratch.push_back(from);
    if ((d_from <= 0) == (d_to <= 0)) continue;
    const double t = d_from / (d_from - d_to);
    // Where the polygon is left, the side of b begins; where it is entered, the old side goes on.
    scratch.push_back({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y),
                       d_from <= 0 ? index_b : from.beyond});
  }
  cell.swap(scratch);
}

}  // namespace

std::vector<VoronoiCell> voronoiCells(const std::vector<Point>& points, const Rectangle& arena) {
  const double steps_per_metre =
      std::min(kFinestPerMetre, kMostSteps / std::max(arena.width(), arena.height()));
  using Site = boost::polygon::point_data<std::int32_t>;
  std::vector<Site> sites;
  std::vector<Point> placed;
  std::set<std::pair<std::int32_t, std::int32_t>> taken;
  sites.reserve(points.size());
  placed.reserve(points.size());
  const auto width = static_cast<std::int32_t>(arena.width() * steps_per_metre);
  for (const Point& point : points) {
    auto column = static_cast<std::int32_t>(
        std::lround((arena.nearestX(point.x) - arena.left) * steps_per_metre));
    const auto row = static_cast<std::int32_t>(
        std::lround((arena.nearestY(point.y) - arena.bottom) * steps_per_metre));
    const std::int32_t step = column < width / 2 ? 1 : -1;
    while (!taken.emplace(column, row).second) column += step;
    sites.emplace_back(column, row);
    placed.push_back({arena.left + column / steps_per_metre, arena.bottom + row / steps_per_metre});
  }
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);

  std::vector<std::vector<std::size_t>> adjacent(points.size());
  for (const auto& edge : diagram.edges()) {
    adjacent[edge.cell()->source_index()].push_back(edge.twin()->cell()->source_index());
  }
  std::vector<VoronoiCell> cells(points.size());
  std::vector<Corner> corners;
  std::vector<Corner> scratch;
  const double shortest = kShortestSide * std::max(arena.width(), arena.height());
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners = {{arena.left, arena.bottom, kWall},
               {arena.right, arena.bottom, kWall},
               {arena.right, arena.top, kWall},
               {arena.left, arena.top, kWall}};
    for (const std::size_t other : adjacent[i]) {
      clip(corners, scratch, placed[i], placed[other], other);
    }
    VoronoiCell& cell = cells[i];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Corner& from = corners[k];
      const Corner& to = corners[(k + 1) % corners.size()];
      cell.area += 0.5 * ((from.x - placed[i].x) * (to.y - placed[i].y) -
                          (to.x - placed[i].x) * (from.y - placed[i].y));
      if (std::hypot(to.x - from.x, to.y - from.y) < shortest) continue;
      if (from.beyond == kWall) {
        cell.at_wall = true;
      } else {
        cell.neighbours.push_back(from.beyond);
      }
    }
  }
  return cells;
}

BondOrder hexaticOf(const std::vector<Point>& points, std::size_t index, const VoronoiCell& cell) {
  BondOrder sum;
  for (const std::size_t other : cell.neighbours) {
    const double dx = points[other].x - points[index].x;
    const double dy = points[other].y - points[index].y;
    const double r2 = dx * dx + dy * dy;
    if (r2 == 0) continue;
    // exp(6 i phi) from (dx + i dy)^6, without trigonometry.
    const double x2 = dx * dx - dy * dy;
    const double y2 = 2 * dx * dy;
    const double x4 = x2 * x2 - y2 * y2;
    const double y4 = 2 * x2 * y2;
    const double r6 = r2 * r2 * r2;
    sum.real += (x4 * x2 - y4 * y2) / r6;
    sum.imaginary += (x4 * y2 + y4 * x2) / r6;
  }
  const auto count = static_cast<double>(cell.neighbours.size());
  return count == 0 ? sum : BondOrder{sum.real / count, sum.imaginary / count};
}

}  // namespace lab::collective
