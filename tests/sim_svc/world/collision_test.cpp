#include "sim_svc/world/collision.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::sim {
namespace {

constexpr double kDistance = 0.075;
constexpr double kSquared = kDistance * kDistance;

TEST(FreeShareToDisk, StopsAtTheContactDistanceHeadOn) {
  EXPECT_NEAR(freeShareToDisk({0.1, 0}, {0.05, 0}, kSquared), 0.5, 1e-14);
  EXPECT_EQ(freeShareToDisk({0.1, 0}, {0.02, 0}, kSquared), 1);
}

TEST(FreeShareToDisk, StopsAtTheContactDistanceFromAnySide) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    for (const double aside : {-0.07, -0.03, 0.0, 0.05}) {
      const double c = std::cos(degrees * 0.0174532925);
      const double s = std::sin(degrees * 0.0174532925);
      const Vec to_other = {0.2 * c - aside * s, 0.2 * s + aside * c};
      const Vec move = {0.2 * c, 0.2 * s};
      const double share = freeShareToDisk(to_other, move, kSquared);
      ASSERT_LT(share, 1);
      const double left = std::hypot(to_other.x - share * move.x, to_other.y - share * move.y);
      ASSERT_NEAR(left, kDistance, 1e-13);
    }
  }
}

TEST(FreeShareToDisk, DoesNotLimitAMoveThatMissesOrLeaves) {
  EXPECT_EQ(freeShareToDisk({0.1, 0.08}, {0.3, 0}, kSquared), 1);
  EXPECT_EQ(freeShareToDisk({0.075, 0}, {-0.01, 0}, kSquared), 1);
  EXPECT_EQ(freeShareToDisk({0.075, 0}, {0, 0.01}, kSquared), 1) << "along the tangent";
  EXPECT_EQ(freeShareToDisk({0.07, 0}, {-0.01, 0}, kSquared), 1) << "out of an overlap";
}

TEST(FreeShareToDisk, StopsAMoveIntoATouchingDisk) {
  EXPECT_EQ(freeShareToDisk({0.075, 0}, {0.01, 0.005}, kSquared), 0);
}

TEST(FreeShareToWalls, StopsAtEachWall) {
  const Arena arena{1.2, 0.9};
  const double r = 0.0375;
  EXPECT_NEAR(freeShareToWalls(arena, r, {0.05, 0.5}, {-0.025, 0}), 0.5, 1e-14);
  EXPECT_NEAR(freeShareToWalls(arena, r, {1.15, 0.5}, {0.05, 0}), 0.25, 1e-13);
  EXPECT_NEAR(freeShareToWalls(arena, r, {0.5, 0.05}, {0.3, -0.025}), 0.5, 1e-14);
  EXPECT_NEAR(freeShareToWalls(arena, r, {0.5, 0.85}, {0, 0.05}), 0.25, 1e-13);
  EXPECT_EQ(freeShareToWalls(arena, r, {0.5, 0.5}, {0.1, 0.1}), 1);
  EXPECT_EQ(freeShareToWalls(arena, r, {r, 0.5}, {-0.01, 0.01}), 0);
  EXPECT_EQ(freeShareToWalls(arena, r, {r, 0.5}, {0.01, 0.01}), 1);
}

}  // namespace
}  // namespace lab::sim
