#include "analyzer/collective/rectangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lab::collective::rectangle_test {
namespace {

using std::numbers::pi;

const Rectangle kArena{0.1, -0.2, 1.3, 0.7};

/// The area by the lengths of horizontal chords.
double areaByChords(double x, double y, double radius, const Rectangle& r) {
  constexpr int kSteps = 20'000;
  double area = 0;
  const double low = std::max(y - radius, r.bottom);
  const double high = std::min(y + radius, r.top);
  if (high <= low) return 0;
  const double step = (high - low) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double v = low + (i + 0.5) * step - y;
    const double half = std::sqrt(radius * radius - v * v);
    area += step * std::max(0.0, std::min(x + half, r.right) - std::max(x - half, r.left));
  }
  return area;
}

TEST(DiscArea, IsThatOfTheWholeDiscAwayFromWalls) {
  EXPECT_DOUBLE_EQ(discAreaInside(0.7, 0.2, 0.3, kArena), pi * 0.09);
}

TEST(DiscArea, IsHalvedByAWallAndQuarteredByACorner) {
  EXPECT_NEAR(discAreaInside(0.1, 0.2, 0.3, kArena), pi * 0.09 / 2, 1e-15);
  EXPECT_NEAR(discAreaInside(1.3, 0.7, 0.3, kArena), pi * 0.09 / 4, 1e-15);
}

TEST(DiscArea, IsThatOfTheArenaForALargeDisc) {
  EXPECT_NEAR(discAreaInside(0.4, 0.3, 5, kArena), kArena.area(), 1e-13);
}

TEST(DiscArea, AgreesWithChordsAnywhere) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 500; ++k) {
    const double x = kArena.left + kArena.width() * unit(random);
    const double y = kArena.bottom + kArena.height() * unit(random);
    const double radius = 1.5 * unit(random);

    const double area = areaByChords(x, y, radius, kArena);

    EXPECT_NEAR(discAreaInside(x, y, radius, kArena), area, 2e-5) << x << " " << y << " " << radius;
    EXPECT_NEAR(discAreaIn(x, y, radius, kArena), area, 2e-5) << x << " " << y << " " << radius;
  }
}

TEST(DiscArea, OfBoxesAddsUpToTheDisc) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 200; ++k) {
    const double x = unit(random);
    const double y = unit(random);
    const double radius = 0.5 * unit(random);
    double sum = 0;
    for (int row = -4; row < 8; ++row) {
      for (int column = -4; column < 8; ++column) {
        sum += discAreaIn(x, y, radius,
                          {0.2 * column, 0.2 * row, 0.2 * column + 0.2, 0.2 * row + 0.2});
      }
    }

    EXPECT_NEAR(sum, pi * radius * radius, 1e-12);
  }
}

TEST(Rectangle, ShrinksToItsCentreLineAtMost) {
  const Rectangle line = Rectangle{0, 0, 2, 1}.shrunk(0.8);

  EXPECT_DOUBLE_EQ(line.bottom, line.top);
  EXPECT_DOUBLE_EQ(line.width(), 0.4);
}

}  // namespace
}  // namespace lab::collective::rectangle_test
