#include "analyzer/collective/voronoi_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <set>

#include "tests/analyzer/collective/hard_discs.hpp"

namespace lab::collective::voronoi_test {
namespace {

const Rectangle kArena{0, 0, 1.2, 0.9};

std::vector<Point> randomPoints(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({1.2 * unit(random), 0.9 * unit(random)});
  return points;
}

double sumOf(const std::vector<VoronoiCell>& cells) {
  double sum = 0;
  for (const VoronoiCell& cell : cells) sum += cell.area;
  return sum;
}

TEST(VoronoiCells, FillTheArena) {
  for (const std::size_t count : {1U, 2U, 3U, 10U, 100U, 700U}) {
    const auto cells = voronoiCells(randomPoints(count, count), kArena);

    ASSERT_EQ(cells.size(), count);
    EXPECT_NEAR(sumOf(cells), kArena.area(), 1e-9);
  }
}

TEST(VoronoiCells, AreThePlacesNearestToTheirPoint) {
  const std::vector<Point> points = randomPoints(25, 3);
  constexpr int kColumns = 1200;
  constexpr int kRows = 900;
  std::vector<double> areas(points.size(), 0.0);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double x = 1.2 * (column + 0.5) / kColumns;
      const double y = 0.9 * (row + 0.5) / kRows;
      const auto nearest = std::min_element(points.begin(), points.end(), [&](auto& a, auto& b) {
        return std::hypot(a.x - x, a.y - y) < std::hypot(b.x - x, b.y - y);
      });
      areas[static_cast<std::size_t>(nearest - points.begin())] += kArena.area() / kColumns / kRows;
    }
  }

  const auto cells = voronoiCells(points, kArena);

  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(cells[i].area, areas[i], 1e-4);
}

/// Independent: two points are neighbours if some point on their bisector, inside the arena, is
/// nearest to both.
std::set<std::size_t> neighboursOf(const std::vector<Point>& points, std::size_t i) {
  std::set<std::size_t> found;
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j == i) continue;
    const double mx = 0.5 * (points[i].x + points[j].x);
    const double my = 0.5 * (points[i].y + points[j].y);
    const double dx = points[j].x - points[i].x;
    const double dy = points[j].y - points[i].y;
    double low = -10;
    double high = 10;                             // places m + t (-dy, dx)
    const auto limit = [&](double a, double b) {  // a t <= b
      if (a > 0) high = std::min(high, b / a);
      if (a < 0) low = std::max(low, b / a);
      if (a == 0 && b < 0) high = low - 1;
    };
    limit(-dy, 1.2 - mx);
    limit(dy, mx);
    limit(dx, 0.9 - my);
    limit(-dx, my);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (k == i || k == j) continue;
      const double nx = points[k].x - points[i].x;
      const double ny = points[k].y - points[i].y;
      const double c = 0.5 * (nx * (points[i].x + points[k].x) + ny * (points[i].y + points[k].y));
      limit(-nx * dy + ny * dx, c - nx * mx - ny * my);
    }
    if (high > low) found.insert(j);
  }
  return found;
}

TEST(VoronoiCells, HaveTheNeighboursAcrossTheirSides) {
  const std::vector<Point> points = randomPoints(60, 4);

  const auto cells = voronoiCells(points, kArena);

  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::set<std::size_t> found(cells[i].neighbours.begin(), cells[i].neighbours.end());
    EXPECT_EQ(found.size(), cells[i].neighbours.size());
    EXPECT_EQ(found, neighboursOf(points, i)) << "point " << i;
  }
}

TEST(VoronoiCells, KnowWhichOnesTouchAWall) {
  std::vector<Point> points;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      points.push_back({0.15 + 0.3 * column, 0.15 + 0.3 * row});
    }
  }

  const auto cells = voronoiCells(points, kArena);

  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(cells[i].at_wall, i != 5 && i != 6) << i;
    EXPECT_NEAR(cells[i].area, 0.09, 1e-7);  // places have steps of 0.1 um
  }
  EXPECT_EQ(cells[5].neighbours.size(), 4U);  // corners at which four cells meet are no sides
}

TEST(VoronoiCells, TakeCoincidingPointsAndPointsOutside) {
  const std::vector<Point> points{{0.3, 0.3}, {0.3, 0.3}, {0.3, 0.3}, {-5, 2},
                                  {0, 0},     {0, 0},     {1.2, 0.9}, {1.2, 0.9}};

  const auto cells = voronoiCells(points, kArena);

  EXPECT_NEAR(sumOf(cells), kArena.area(), 1e-9);
}

TEST(HexaticOrder, IsOneInATriangularLattice) {
  std::vector<Point> points;
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      points.push_back({0.1 + 0.1 * (column + 0.5 * (row % 2)), 0.05 + 0.0866025404 * row});
    }
  }
  const auto cells = voronoiCells(points, kArena);
  int inner = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (cells[i].at_wall) continue;
    const BondOrder order = hexaticOf(points, i, cells[i]);
    EXPECT_NEAR(order.real, 1, 1e-5);
    EXPECT_NEAR(order.imaginary, 0, 1e-5);
    ++inner;
  }
  EXPECT_GE(inner, 35);
}

TEST(HexaticOrder, TurnsSixTimesWithTheLattice) {
  constexpr double kTurn = 0.2;
  std::vector<Point> points{{0.6, 0.45}};
  for (int k = 0; k < 6; ++k) {
    const double angle = kTurn + k * std::numbers::pi / 3;
    points.push_back({0.6 + 0.1 * std::cos(angle), 0.45 + 0.1 * std::sin(angle)});
  }

  const BondOrder order = hexaticOf(points, 0, voronoiCells(points, kArena)[0]);

  EXPECT_NEAR(order.real, std::cos(6 * kTurn), 1e-9);
  EXPECT_NEAR(order.imaginary, std::sin(6 * kTurn), 1e-9);
}

double hexaticOfDiscs(double packing) {
  HardDiscs discs(24, 24, packing, 5);
  for (int k = 0; k < 2000; ++k) discs.sweep();
  double sum = 0;
  double count = 0;
  for (int frame = 0; frame < 20; ++frame) {
    for (int k = 0; k < 20; ++k) discs.sweep();
    std::vector<Point> points;
    for (const auto& [x, y] : discs.places()) points.push_back({x / 100, y / 100});
    const auto cells = voronoiCells(points, {0, 0, discs.width() / 100, discs.height() / 100});
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (cells[i].at_wall) continue;
      const BondOrder order = hexaticOf(points, i, cells[i]);
      sum += std::hypot(order.real, order.imaginary);
      ++count;
    }
  }
  return sum / count;
}

// Hard discs are fluid below a packing of 0.700 and solid above 0.720 (Bernard and Krauth,
// Phys. Rev. Lett. 107, 155704, 2011).
TEST(HexaticOrder, TellsFluidFromSolid) {
  EXPECT_LT(hexaticOfDiscs(0.30), 0.55);
  EXPECT_GT(hexaticOfDiscs(0.78), 0.85);
}

}  // namespace
}  // namespace lab::collective::voronoi_test
