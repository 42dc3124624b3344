// Motility-induced phase separation of robots that push each other.
//
// Without friction and rotation by contact forces, and with the same slip in all directions, robots
// are athermal active Brownian hard disks. They separate into a dense and a dilute phase if they
// are persistent and dense enough: Fily, Henkes and Marchetti, Soft Matter 10, 2132 (2014) and
// Martin-Roca and others, J. Chem. Phys. 154, 164901 (2021) without thermal motion; with thermal
// motion the critical point is at v / (D_r d) = 13.3 +- 0.7 and a packing fraction of
// 0.597 +- 0.003 (Siebert and others, Phys. Rev. E 98, 030601, 2018: Pe = 3 v / (D_r d) = 40 +- 2).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "analyzer/collective/voronoi_cells.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim::phase_separation_test {
namespace {

constexpr double kDiameter = 0.075;  // [m]
constexpr double kDiskArea = std::numbers::pi * kDiameter * kDiameter / 4;
constexpr double kSpeed = 0.05;   // [m/s]
constexpr double kEpsilon = 0.5;  // [s] hold time, short compared with 1 / D_r
constexpr double kPacking = 0.6;
constexpr int kPerRow = 30;       // of the initial lattice
constexpr int kTurningTimes = 8;  // duration of a run [1 / D_r]
constexpr std::size_t kBins = 22;
constexpr double kBinWidth = 0.05;
constexpr double kWallLayer =
    5;  // [diameters] not evaluated, because walls collect active particles

/// Numbers of robots outside of the wall layer by local packing fraction (Voronoi cells) in the
/// second half of the run, smoothed.
/// @param persistence v / (D_r d)
std::array<double, kBins> histogramOf(double persistence, std::uint64_t seed) {
  constexpr int kCount = kPerRow * kPerRow;
  const double side = std::sqrt(kCount * kDiskArea / kPacking);
  WorldSettings settings = idealHardware();
  settings.arena = {side, side};
  settings.contact_friction = 0;
  settings.slip = {1, 0};
  settings.ir_range = 0.001;
  settings.tick_us = 40000;
  settings.seed = seed;
  std::vector<RobotSetup> setups;
  const double spacing = side / kPerRow;
  for (int i = 0; i < kCount; ++i) {
    setups.push_back(
        {i + 1,
         dynamics::Pose{(i % kPerRow + 0.5) * spacing, (i / kPerRow + 0.5) * spacing, 2.4 * i},
         false});
  }
  World dut(settings, setups);
  // D_r = epsilon eta^2 / 6.
  const double rotation = kSpeed / (persistence * kDiameter);
  dynamics::CoreSettings core =
      always(abpProgram(kSpeed, kEpsilon, std::sqrt(6 * rotation / kEpsilon)));
  core.reversal.enabled = false;
  startAll(dut, core);
  std::array<double, kBins> histogram{};
  const auto duration = static_cast<int>(kTurningTimes / rotation);  // [s]
  for (int second = 0; second <= duration; second += 5) {
    dut.advanceTo(second * kSecond);
    if (2 * second < duration) continue;
    std::vector<collective::Point> points;
    for (std::size_t i = 0; i < dut.size(); ++i) points.push_back({dut.pose(i).x, dut.pose(i).y});
    const auto cells = collective::voronoiCells(points, {0, 0, side, side});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const collective::Point& p = points[i];
      if (std::min({p.x, p.y, side - p.x, side - p.y}) < kWallLayer * kDiameter) continue;
      const double packing = kDiskArea / cells[i].area;
      histogram[std::min(kBins - 1, static_cast<std::size_t>(packing / kBinWidth))] += 1;
    }
  }
  EXPECT_EQ(dut.sliding().unsolvedIslands(), 0);
  for (int pass = 0; pass < 2; ++pass) {
    auto smooth = histogram;
    for (std::size_t b = 1; b + 1 < kBins; ++b) {
      smooth[b] = 0.25 * histogram[b - 1] + 0.5 * histogram[b] + 0.25 * histogram[b + 1];
    }
    histogram = smooth;
  }
  return histogram;
}

/// How deep the valley between a dilute phase, below 0.45, and a dense phase, above 0.6, is: 1 -
/// the minimum between the maxima / the lower maximum. 0: there is one phase.
double valleyOf(const std::array<double, kBins>& histogram) {
  const auto* const dilute = std::max_element(histogram.begin(), histogram.begin() + 9);
  const auto* const dense = std::max_element(histogram.begin() + 12, histogram.end());
  const auto* const valley = std::min_element(dilute, dense);
  return 1 - *valley / std::min(*dilute, *dense);
}

struct Case {
  double persistence;
  double lowest;  ///< Of the depth of the valley.
  double highest;
  std::uint64_t seeds = 1;
};

class PhaseSeparation : public testing::TestWithParam<Case> {};

TEST_P(PhaseSeparation, BeginsAtThePublishedPersistence) {
  const auto& [persistence, lowest, highest, seeds] = GetParam();
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const std::array<double, kBins> histogram = histogramOf(persistence, seed);
    const double valley = valleyOf(histogram);
    std::printf("v / (D_r d) = %.0f, seed %d: valley %.3f, local packing fraction by 0.05:",
                persistence, static_cast<int>(seed), valley);
    for (const double count : histogram) std::printf(" %.0f", count);
    std::printf("\n");
    EXPECT_GE(valley, lowest);
    EXPECT_LE(valley, highest);
  }
}

INSTANTIATE_TEST_SUITE_P(OfOnePhase, PhaseSeparation,
                         testing::Values(Case{8, 0, 0.02}, Case{11, 0, 0.05, 2}));
INSTANTIATE_TEST_SUITE_P(OfTwoPhases, PhaseSeparation,
                         testing::Values(Case{14, 0.05, 1, 2}, Case{20, 0.2, 1}));

}  // namespace
}  // namespace lab::sim::phase_separation_test
