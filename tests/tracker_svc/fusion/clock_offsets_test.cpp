#include "tracker_svc/fusion/clock_offsets.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace lab::tracker::clock_offsets_test {
namespace {

constexpr std::array<double, 3> kOffsets{0, 0.004, -0.011};  // [s]

/// Robots of 4 cm/s in random directions, seen by cameras 0 and 1, or 1 and 2.
ClockOffsets measured(std::mt19937_64& random, int robots, double noise) {
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> angle(0, 2 * M_PI);
  const Eigen::Vector2d shift(2e-4, -1e-4);  // [m] between calibrations
  const Eigen::Matrix2d covariance = noise * noise * Eigen::Matrix2d::Identity();
  ClockOffsets offsets(3);
  for (int i = 0; i < robots; ++i) {
    const std::size_t a = i % 2 == 0 ? 0 : 2;  // also with the later camera first
    const double heading = angle(random);
    const Eigen::Vector2d velocity(0.04 * std::cos(heading), 0.04 * std::sin(heading));
    const Eigen::Vector2d error(normal(random), normal(random));
    offsets.add(a, 1, shift - velocity * (kOffsets[1] - kOffsets[a]) + error, velocity, covariance);
  }
  return offsets;
}

TEST(ClockOffsets, AreExactWithoutNoiseAlsoAlongAChain) {
  std::mt19937_64 random(1);
  std::vector<ClockOffset> offsets = measured(random, 200, 1e-9).solve();
  EXPECT_EQ(offsets[0].offset, 0);
  EXPECT_EQ(offsets[0].sigma, 0);
  EXPECT_NEAR(offsets[1].offset, 0.004, 1e-7);
  EXPECT_NEAR(offsets[2].offset, -0.011, 1e-7);
}

TEST(ClockOffsets, StandardErrorCoversTheTruth) {
  std::mt19937_64 random(2);
  constexpr int kTrials = 1000;
  std::array<int, 3> covered{};
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::vector<ClockOffset> offsets = measured(random, 200, 1e-4).solve();
    for (std::size_t i = 1; i < 3; ++i) {
      if (std::abs(offsets[i].offset - kOffsets[i]) <= offsets[i].sigma) ++covered[i];
    }
  }
  // One standard error covers 68.3 %; chi-square above 1 only enlarges it, by about 1 %. The
  // standard deviation of the share is 1.5 %.
  EXPECT_NEAR(covered[1], 690, 5 * 15);
  EXPECT_NEAR(covered[2], 690, 5 * 15);
}

TEST(ClockOffsets, StandardErrorFollowsTheLaw) {
  std::mt19937_64 random(4);
  const std::vector<ClockOffset> offsets = measured(random, 4000, 1e-4).solve();
  // sigma = noise / (root mean square of a velocity component x root of 2 x 2000 components)
  EXPECT_NEAR(offsets[1].sigma, 1e-4 / (0.04 / std::sqrt(2.0) * std::sqrt(4000.0)), 0.1 * 5.6e-5);
}

TEST(ClockOffsets, AreUnknownWithoutMotionOrWithoutOverlap) {
  ClockOffsets still(2);
  for (int i = 0; i < 100; ++i) {
    still.add(0, 1, {1e-4, 0}, {0, 0}, 1e-8 * Eigen::Matrix2d::Identity());
  }
  EXPECT_TRUE(std::isinf(still.solve()[1].sigma));
  EXPECT_TRUE(std::isinf(ClockOffsets(2).solve()[1].sigma));
}

}  // namespace
}  // namespace lab::tracker::clock_offsets_test
