#include "tracker_svc/fusion/view_comparison.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace lab::tracker::view_comparison_test {
namespace {

constexpr std::array<double, 3> kOffsets{0, 0.004, -0.011};  // [s]

/// Robots of 4 cm/s in random directions, seen by cameras 0 and 1, or 1 and 2.
ViewComparison measured(std::mt19937_64& random, int robots, double noise) {
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> angle(0, 2 * M_PI);
  const Eigen::Vector2d shift(2e-4, -1e-4);  // [m] between calibrations
  const Eigen::Matrix2d covariance = noise * noise * Eigen::Matrix2d::Identity();
  ViewComparison offsets(3);
  for (int i = 0; i < robots; ++i) {
    const std::size_t a = i % 2 == 0 ? 0 : 2;  // also with the later camera first
    const double heading = angle(random);
    const Eigen::Vector2d velocity(0.04 * std::cos(heading), 0.04 * std::sin(heading));
    const Eigen::Vector2d error(normal(random), normal(random));
    offsets.add(a, 1, {0.5, 0.5}, shift - velocity * (kOffsets[1] - kOffsets[a]) + error, velocity,
                covariance);
  }
  return offsets;
}

TEST(ClockOffsets, AreExactWithoutNoiseAlsoAlongAChain) {
  std::mt19937_64 random(1);
  std::vector<ClockOffset> offsets = measured(random, 200, 1e-9).clocks();
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
    const std::vector<ClockOffset> offsets = measured(random, 200, 1e-4).clocks();
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
  const std::vector<ClockOffset> offsets = measured(random, 4000, 1e-4).clocks();
  // sigma = noise / (root mean square of a velocity component x root of 2 x 2000 components)
  EXPECT_NEAR(offsets[1].sigma, 1e-4 / (0.04 / std::sqrt(2.0) * std::sqrt(4000.0)), 0.1 * 5.6e-5);
}

TEST(ClockOffsets, AreUnknownWithoutMotionOrWithoutOverlap) {
  ViewComparison still(2);
  for (int i = 0; i < 100; ++i) {
    still.add(0, 1, {0.5, 0.5}, {1e-4, 0}, {0, 0}, 1e-8 * Eigen::Matrix2d::Identity());
  }
  EXPECT_TRUE(std::isinf(still.clocks()[1].sigma));
  EXPECT_TRUE(std::isinf(ViewComparison(2).clocks()[1].sigma));
}

/// Two cameras with views of 1 m x 0.8 m that overlap by 0.24 m. Robots of 4 cm/s in random
/// directions are seen by both, at random places of the overlap.
struct TwoViews {
  ViewError left{{0.5, 0.4}, {3e-4, -2e-4}, Eigen::Matrix2d{{1e-4, -8e-4}, {1e-3, -2e-4}}};
  ViewError right{{1.26, 0.4}, {-4e-4, 5e-4}, Eigen::Matrix2d{{-2e-4, 6e-4}, {-5e-4, 1e-4}}};

  [[nodiscard]] ViewComparison seen(int robots) const {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    ViewComparison views(2);
    for (int i = 0; i < robots; ++i) {
      const Eigen::Vector2d place(0.76 + 0.24 * share(random), 0.8 * share(random));
      const double heading = 2 * M_PI * share(random);
      const Eigen::Vector2d velocity(0.04 * std::cos(heading), 0.04 * std::sin(heading));
      const Eigen::Vector2d apart = right.at(place.x(), place.y()) - left.at(place.x(), place.y());
      views.add(0, 1, place, apart - velocity * 0.004, velocity,
                4e-10 * Eigen::Matrix2d::Identity());
      views.addToView(0, {share(random), 0.8 * share(random)});
      views.addToView(1, {0.76 + share(random), 0.8 * share(random)});
    }
    return views;
  }
};

TEST(ViewComparison, RemovesTheDifferenceOfTwoCalibrationsInTheOverlap) {
  const TwoViews scene;
  const ViewComparison views = scene.seen(4000);
  const std::vector<ClockOffset> clocks = views.clocks();
  EXPECT_NEAR(clocks[1].offset, 0.004, 1e-5);  // though the displacement varies with the place
  const std::vector<ViewError> errors = views.errors(clocks, 5e-4);
  for (const double x : {0.78, 0.88, 0.98}) {
    for (const double y : {0.05, 0.4, 0.75}) {
      const Eigen::Vector2d before = scene.right.at(x, y) - scene.left.at(x, y);
      const Eigen::Vector2d after = before - (errors[1].at(x, y) - errors[0].at(x, y));
      EXPECT_GT(before.norm(), 3e-4);
      EXPECT_LT(after.norm(), 4e-5) << x << ", " << y;
    }
  }
  // Each takes its part of the difference, so the mean shift of both remains.
  EXPECT_LT((errors[0].shift + errors[1].shift).norm(), 1e-4);
}

TEST(ViewComparison, ChangesNothingWhereOffsetsAreNotKnown) {
  const ViewComparison views = TwoViews().seen(4000);
  std::vector<ClockOffset> clocks = views.clocks();
  clocks[1].sigma = 1e-3;
  for (const ViewError& error : views.errors(clocks, 5e-4)) {
    EXPECT_EQ(error.at(0.9, 0.3), Eigen::Vector2d::Zero());
    EXPECT_EQ(error.rotation(), 0);
  }
}

}  // namespace
}  // namespace lab::tracker::view_comparison_test
