#include "sim_svc/world/ir_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::sim {
namespace {

constexpr double kRadius = 0.0375;
constexpr double kRange = 0.05;
constexpr double kPi = 3.14159265358979323846;
const Arena kArena{1.2, 0.9};

Vec unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

TEST(IrScan, ReadsNothingInTheMiddleOfTheArena) {
  IrScan dut({0.6, 0.45}, {1, 0}, kRadius, kRange);
  dut.addWalls(kArena);
  EXPECT_FALSE(dut.anyInRange());
  for (const int counts : dut.counts()) EXPECT_EQ(counts, 0);
}

TEST(IrScan, ReadsAWallAheadLinearly) {
  for (const double gap : {0.0, 0.01, 0.025, 0.049}) {
    IrScan dut({1.2 - kRadius - gap, 0.45}, {1, 0}, kRadius, kRange);
    dut.addWalls(kArena);
    EXPECT_EQ(dut.counts()[0], std::lround(1023 * (1 - gap / kRange))) << gap;
    EXPECT_EQ(dut.counts()[3], 0);
  }
}

TEST(IrScan, ReadsAWallAtAnAngleWithTheSideSensors) {
  const double gap = 0.004;
  IrScan dut({1.2 - kRadius - gap, 0.45}, {1, 0}, kRadius, kRange);
  dut.addWalls(kArena);
  // At 60 degrees the distance is (R + gap) / cos 60 from the centre, and R less from the rim.
  const double slant = 2 * (kRadius + gap) - kRadius;
  EXPECT_EQ(dut.counts()[1], std::lround(1023 * (1 - slant / kRange)));
  EXPECT_EQ(dut.counts()[5], dut.counts()[1]);
  EXPECT_EQ(dut.counts()[2], 0);
}

TEST(IrScan, EachSensorHasItsOwnDirection) {
  // In steps of 60 degrees counter-clockwise from the heading.
  const double heading = 0.4;
  for (std::size_t k = 0; k < IrScan::kDirections; ++k) {
    const double angle = heading + static_cast<double>(k) * kPi / 3;
    IrScan dut({0.6, 0.45}, unit(heading), kRadius, kRange);
    const Vec direction = unit(angle);
    dut.addDisk({0.1 * direction.x, 0.1 * direction.y});
    for (std::size_t other = 0; other < IrScan::kDirections; ++other) {
      const double expected = other == k ? 1023 * (1 - 0.025 / kRange) : 0;
      EXPECT_NEAR(dut.counts()[other], expected, other == k ? 1 : 0) << k << " " << other;
    }
  }
}

TEST(IrScan, ReadsADiskOffTheAxisAtItsRim) {
  const double aside = 0.02;
  IrScan dut({0.6, 0.45}, {1, 0}, kRadius, kRange);
  dut.addDisk({0.1, aside});
  const double to_rim = 0.1 - std::sqrt(kRadius * kRadius - aside * aside) - kRadius;
  EXPECT_EQ(dut.counts()[0], std::lround(1023 * (1 - to_rim / kRange)));
  IrScan missing({0.6, 0.45}, {1, 0}, kRadius, kRange);
  missing.addDisk({0.09, 0.04});
  EXPECT_EQ(missing.counts()[0], 0);
}

TEST(IrScan, ReadsTheNearestOfMany) {
  IrScan dut({0.6, 0.45}, {1, 0}, kRadius, kRange);
  dut.addDisk({0.11, 0});
  dut.addDisk({0.09, 0});
  dut.addDisk({0.10, 0});
  EXPECT_EQ(dut.counts()[0], std::lround(1023 * (1 - 0.015 / kRange)));
}

TEST(IrScan, ReadsFullScaleAtContact) {
  IrScan dut({0.6, 0.45}, {1, 0}, kRadius, kRange);
  dut.addDisk({-0.075, 0});
  EXPECT_EQ(dut.counts()[3], 1023);
}

}  // namespace
}  // namespace lab::sim
