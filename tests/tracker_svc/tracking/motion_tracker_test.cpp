#include "tracker_svc/tracking/motion_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include "tracker_svc/tracking/tag_tracker.hpp"

namespace lab::tracker::motion_tracker_test {
namespace {

constexpr double kInterval = 0.1;  // [s]

/// Particles in a box with periodic places; steps persist or not.
struct Particles {
  struct One {
    double x, y, vx, vy;
  };
  std::vector<One> all;
  std::mt19937_64 random;
  double side;
  double persistence;
  double noise;

  Particles(int count, double the_side, double the_persistence, double the_noise,
            std::uint64_t seed)
      : random(seed), side(the_side), persistence(the_persistence), noise(the_noise) {
    std::uniform_real_distribution<double> place(0, side);
    for (int i = 0; i < count; ++i) all.push_back({place(random), place(random), 0, 0});
  }

  void step() {
    std::normal_distribution<double> normal(0, noise);
    for (One& one : all) {
      one.vx = persistence * one.vx + normal(random);
      one.vy = persistence * one.vy + normal(random);
      one.x += one.vx;
      one.y += one.vy;
      // Reflected at the walls.
      if (one.x < 0 || one.x > side) {
        one.x = one.x < 0 ? -one.x : 2 * side - one.x;
        one.vx = -one.vx;
      }
      if (one.y < 0 || one.y > side) {
        one.y = one.y < 0 ? -one.y : 2 * side - one.y;
        one.vy = -one.vy;
      }
    }
  }

  /// Each is missed with a probability. The middle's x is the number of the particle.
  [[nodiscard]] std::vector<detector::Detection> seen(double missed) {
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<detector::Detection> found;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (share(random) < missed) continue;
      detector::Detection one;
      one.x = all[i].x;
      one.y = all[i].y;
      one.quality = 0.9F;
      one.heading = detector::HeadingKind::kUnknown;
      one.covariance = {1e-10, 0, 0, 1e-10, 0, 3};
      one.middle = {static_cast<double>(i), 0};
      found.push_back(one);
    }
    return found;
  }
};

struct Swaps {
  double expected = 0;
  double variance = 0;
  int counted = 0;
  int links = 0;
};

Swaps swapsOf(Particles particles, int pictures, double missed) {
  MotionTracker dut({.step = 0.003, .area = particles.side * particles.side});
  std::map<std::int64_t, int> before;
  Swaps swaps;
  for (int k = 0; k < pictures; ++k) {
    particles.step();
    for (const Track& track : dut.update(k * kInterval, particles.seen(missed))) {
      if (!track.detected) continue;
      const int particle = static_cast<int>(track.pose.middle.x);
      const auto [at, is_new] = before.try_emplace(track.number, particle);
      if (!is_new) {
        ++swaps.links;
        swaps.expected += track.swap;
        swaps.variance += track.swap * (1 - track.swap);
        if (at->second != particle) ++swaps.counted;
      }
      at->second = particle;
    }
  }
  return swaps;
}

TEST(MotionTracker, KeepsTheNumbersOfSparseParticles) {
  const Swaps swaps = swapsOf(Particles(20, 1, 0.9, 0.0005, 1), 200, 0);
  EXPECT_EQ(swaps.links, 20 * 199);
  EXPECT_LE(swaps.counted, 1);
  EXPECT_LT(swaps.expected, 2);
}

/// Crowds in which swaps happen: as many as the probabilities say.
class MotionTrackerCrowd : public testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(MotionTrackerCrowd, HasAsManySwapsAsItExpects) {
  const auto [persistence, noise, missed] = GetParam();
  Swaps sum;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Swaps swaps = swapsOf(Particles(60, 0.5, persistence, noise, seed), 100, missed);
    sum.expected += swaps.expected;
    sum.variance += swaps.variance;
    sum.counted += swaps.counted;
  }
  EXPECT_GT(sum.counted, 20);
  // Swaps come in pairs: twice the variance. After one, speeds are wrong for a picture.
  const double sigma = std::sqrt(2 * sum.variance);
  EXPECT_NEAR(sum.counted, sum.expected, 4 * sigma + 0.25 * sum.expected)
      << "persistence " << persistence << ", noise " << noise << ", missed " << missed;
}

INSTANTIATE_TEST_SUITE_P(Steps, MotionTrackerCrowd,
                         testing::Values(std::tuple(0.0, 0.006, 0.0), std::tuple(0.0, 0.012, 0.0),
                                         std::tuple(0.9, 0.004, 0.0), std::tuple(0.0, 0.006, 0.05),
                                         std::tuple(0.9, 0.003, 0.05)));

TEST(MotionTracker, LearnsTheSteps) {
  Particles particles(30, 1, 0.8, 0.002, 3);
  MotionTracker dut({.step = 0.02});
  for (int k = 0; k < 200; ++k) {
    particles.step();
    static_cast<void>(dut.update(k * kInterval, particles.seen(0)));
  }
  EXPECT_NEAR(dut.model().persistence, 0.8, 0.05);
  EXPECT_NEAR(std::sqrt(dut.model().variance), 0.002, 0.0002);
}

detector::Detection blobAt(double x, double y) {
  detector::Detection one;
  one.x = x;
  one.y = y;
  one.quality = 0.9F;
  one.heading = detector::HeadingKind::kUnknown;
  one.covariance = {1e-10, 0, 0, 1e-10, 0, 3};
  return one;
}

/// A random walk that ends at a place.
std::vector<detector::Detection> walkTo(double x, double y, int steps, std::mt19937_64& random) {
  std::normal_distribution<double> step(0, 0.001);
  std::vector<detector::Detection> path;
  for (int k = 0; k < steps; ++k) {
    path.insert(path.begin(), blobAt(x, y));
    x += step(random);
    y += step(random);
  }
  return path;
}

TEST(MotionTracker, DoubtsWhoIsWhoAfterTwoWereHiddenTogether) {
  constexpr int kSteps = 60;
  constexpr int kHidden = 15;
  MotionTracker dut({.step = 0.002, .patience = 2});
  std::mt19937_64 random(2);
  const auto one = walkTo(0.5, 0.5, kSteps, random);
  const auto two = walkTo(0.504, 0.5, kSteps, random);
  const auto far = walkTo(0.9, 0.2, kSteps + kHidden + 1, random);
  for (std::size_t k = 0; k < kSteps; ++k) {
    static_cast<void>(
        dut.update(static_cast<double>(k) * kInterval, std::vector{one[k], two[k], far[k]}));
  }
  for (std::size_t k = kSteps; k < kSteps + kHidden; ++k) {
    static_cast<void>(dut.update(static_cast<double>(k) * kInterval, std::vector{far[k]}));
  }
  const std::vector<Track>& tracks =
      dut.update((kSteps + kHidden) * kInterval,
                 std::vector{blobAt(0.5, 0.502), blobAt(0.505, 0.498), far.back()});

  ASSERT_EQ(tracks.size(), 3U);
  for (const Track& track : tracks) {
    EXPECT_TRUE(track.detected);
    if (track.pose.x < 0.8) {
      EXPECT_GT(track.swap, 0.1);
    } else {
      EXPECT_LT(track.swap, 0.01);
    }
  }
}

TEST(MotionTracker, LetsNoTrackHaveAGroup) {
  MotionTracker dut({});
  detector::Detection group = blobAt(0.5, 0.5);
  group.merged = 2;
  EXPECT_TRUE(dut.update(0, std::vector{group}).empty());
}

TEST(MotionTracker, TurnsTheAxisTowardsTheMotion) {
  MotionTracker dut({});
  double theta = 0;
  for (int k = 0; k < 30; ++k) {
    detector::Detection one = blobAt(0.2 + 0.005 * k, 0.5);
    one.heading = detector::HeadingKind::kAxis;
    one.length = 0.02F;
    one.theta = std::numbers::pi;  // the other end of the axis
    theta = dut.update(k * kInterval, std::vector{one}).front().pose.theta;
  }
  EXPECT_NEAR(std::remainder(theta, 2 * std::numbers::pi), 0, 1e-6);
}

TEST(TagTracker, BindsTagsToRobotsOfTheirNumber) {
  TagTracker dut(0.27, {3, 4});
  detector::Detection robot = blobAt(0.5, 0.5);
  robot.tag = 3;
  detector::Detection other = blobAt(0.2, 0.5);
  other.tag = 0;
  const std::vector<Track> tracks = dut.update(0, std::vector{robot, other});
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].number, 1);
  EXPECT_EQ(tracks[0].robot_id, -1);
  EXPECT_EQ(tracks[1].number, 4);
  EXPECT_EQ(tracks[1].robot_id, 3);
  EXPECT_EQ(dut.counts().bound, 1);

  EXPECT_FALSE(dut.update(1, {}).front().detected);
  EXPECT_EQ(dut.expect(1.5).size(), 2U);
  EXPECT_TRUE(dut.update(TagTracker::kGiveUp + 0.1, {}).empty());
  EXPECT_EQ(dut.counts().lost, 2);
}

}  // namespace
}  // namespace lab::tracker::motion_tracker_test
