#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analyzer/collective/density_map.hpp"
#include "analyzer/collective/whole_motion.hpp"

namespace lab::collective::maps_and_motion_test {
namespace {

CrowdSettings settings() {
  CrowdSettings settings;
  settings.arena = {0, 0, 1.2, 0.9};
  settings.max_lag = 10;
  return settings;
}

TEST(DensityMap, HasTheDensityAndTheCurrentOfEachPlace) {
  DensityMap dut(settings());
  for (int frame = 0; frame < 100; ++frame) {
    std::vector<CrowdRobot> robots{{1, 0.025, 0.025, 0, 0.05, -0.01}};
    if (frame % 2 == 0) robots.push_back({2, 0.625, 0.475, 0, 0, 0.02});
    dut.add(robots);
  }

  const CrowdMap map = dut.map();

  ASSERT_EQ(map.columns, 24U);
  ASSERT_EQ(map.rows, 18U);
  constexpr double kCell = 0.05 * 0.05;
  const MapCell& corner = map.cells[0];
  const MapCell& other = map.cells[9 * 24 + 12];
  EXPECT_NEAR(other.x, 0.625, 1e-12);
  EXPECT_NEAR(other.y, 0.475, 1e-12);
  EXPECT_NEAR(corner.density.value, 1 / kCell, 1e-9);
  EXPECT_NEAR(corner.current_x.value, 0.05 / kCell, 1e-9);
  EXPECT_NEAR(corner.current_y.value, -0.01 / kCell, 1e-9);
  EXPECT_NEAR(other.density.value, 0.5 / kCell, 1e-9);
  EXPECT_NEAR(other.current_y.value, 0.01 / kCell, 1e-9);
  double robots = 0;
  for (const MapCell& cell : map.cells) robots += cell.density.value * kCell;
  EXPECT_NEAR(robots, 1.5, 1e-9);
}

TEST(WholeMotion, OfUniformMotionIsBallistic) {
  WholeMotion dut(settings());
  for (int k = 0; k < 200; ++k) {
    const double t = 0.2 * k;
    dut.add(t, {{1, 0.1 + 0.003 * t, 0.2 + 0.004 * t, 0.5 * t}, {2, 0.5, 0.5}});
  }

  // Half of the windows are those of the robot that stands, without a heading.
  for (const CurveSample& point : dut.msd().points) {
    EXPECT_NEAR(point.average.value, 0.5 * 25e-6 * point.x * point.x, 1e-6 * point.x) << point.x;
  }
  for (const CurveSample& point : dut.angularMsd().points) {
    EXPECT_NEAR(point.average.value, 0.25 * point.x * point.x, 1e-9) << point.x;
  }
  EXPECT_NEAR(dut.msd().points.back().x, 10, 2);
}

TEST(WholeMotion, OfARandomWalkIsDiffusiveWithItsError) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.01);
  WholeMotion dut(settings());
  std::vector<CrowdRobot> robots;
  for (int i = 0; i < 10; ++i) robots.push_back({i, 0, 0, 0});
  for (int k = 0; k < 5000; ++k) {
    for (CrowdRobot& robot : robots) {
      robot.x += normal(random);
      robot.y += normal(random);
    }
    dut.add(0.2 * k, robots);
  }

  for (const CurveSample& point : dut.msd().points) {
    const double steps = std::round(point.x / 0.2);
    EXPECT_LT(std::abs(point.average.value - 2e-4 * steps) / point.average.sigma, 4) << point.x;
    EXPECT_LT(point.average.sigma, 0.1 * point.average.value);
  }
}

TEST(WholeMotion, HasNoWindowOverAGap) {
  WholeMotion dut(settings());
  for (int k = 0; k < 30; ++k) dut.add(0.2 * k, {{1, 0.1, 0.1, 0}});
  dut.add(7, {{1, 0.9, 0.1, 0}});
  dut.add(7.2, {{1, 0.9, 0.1, 0}});

  for (const CurveSample& point : dut.msd().points) EXPECT_NEAR(point.average.value, 0, 1e-12);
}

}  // namespace
}  // namespace lab::collective::maps_and_motion_test
