#include "sim_svc/placement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace lab::sim::placement_test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kRadius = 0.0375;
const Arena kArena{1.2, 0.9};

std::vector<Place> anywhere(int n) {
  std::vector<Place> places;
  for (int id = 1; id <= n; ++id) places.push_back({id, std::nullopt});
  return places;
}

void expectNoOverlap(const std::vector<dynamics::Pose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSERT_GE(poses[i].x, kRadius);
    ASSERT_LE(poses[i].x, kArena.width - kRadius);
    ASSERT_GE(poses[i].y, kRadius);
    ASSERT_LE(poses[i].y, kArena.height - kRadius);
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GT(std::hypot(poses[i].x - poses[j].x, poses[i].y - poses[j].y), 2 * kRadius);
    }
  }
}

TEST(PlaceRobots, PlacesOneToManyRobotsWithoutOverlap) {
  for (const int n : {1, 20, 80, 150, 170}) {
    expectNoOverlap(placeRobots(anywhere(n), kArena, kRadius, 7));
  }
}

// In seed 1233 of an earlier version an ABP pushed into a corner for minutes.
TEST(PlaceRobots, KeepsAwayFromWallsWhileThereIsRoom) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    for (const dynamics::Pose& pose : placeRobots(anywhere(10), kArena, kRadius, seed)) {
      ASSERT_GE(std::min(pose.x, kArena.width - pose.x), kRadius + 0.05);
      ASSERT_GE(std::min(pose.y, kArena.height - pose.y), kRadius + 0.05);
    }
  }
  const Arena small{0.1, 0.1};
  EXPECT_NO_THROW((void)placeRobots(anywhere(1), small, kRadius, 1));
}

TEST(PlaceRobots, AddingARobotDoesNotMoveTheOthers) {
  const auto few = placeRobots(anywhere(20), kArena, kRadius, 7);
  const auto more = placeRobots(anywhere(21), kArena, kRadius, 7);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].x, more[i].x);
    EXPECT_EQ(few[i].y, more[i].y);
    EXPECT_EQ(few[i].theta, more[i].theta);
  }
}

TEST(PlaceRobots, PlacesManyRobotsInALargeArena) {
  // Overlaps are looked for between neighbours in x.
  const Arena arena{200, 150};
  auto poses = placeRobots(anywhere(100'000), arena, kRadius, 7);
  std::ranges::sort(poses, {}, &dynamics::Pose::x);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSERT_GE(poses[i].x, kRadius);
    ASSERT_LE(poses[i].y, arena.height - kRadius);
    for (std::size_t j = i; j-- > 0 && poses[i].x - poses[j].x <= 2 * kRadius;) {
      ASSERT_GT(std::hypot(poses[i].x - poses[j].x, poses[i].y - poses[j].y), 2 * kRadius);
    }
  }
}

TEST(PlaceRobots, KeepsThePlacesOfASeed) {
  // Other places would change every run of a seed.
  const auto sparse = placeRobots(anywhere(100), kArena, kRadius, 7);
  EXPECT_EQ(sparse[99].x, 0.3219791058402931);
  EXPECT_EQ(sparse[99].y, 0.21502293016529364);
  const auto dense = placeRobots(anywhere(170), kArena, kRadius, 7);
  EXPECT_EQ(dense[169].x, 0.8116228208357914);
  EXPECT_EQ(dense[169].y, 0.037613068879269664);
}

TEST(PlaceRobots, AnotherSeedGivesOtherPoses) {
  EXPECT_NE(placeRobots(anywhere(1), kArena, kRadius, 7)[0].x,
            placeRobots(anywhere(1), kArena, kRadius, 8)[0].x);
}

TEST(PlaceRobots, KeepsGivenPosesAndAvoidsThem) {
  std::vector<Place> places = anywhere(100);
  places[50].given = dynamics::Pose{0.3, 0.4, 1};
  const auto poses = placeRobots(places, kArena, kRadius, 7);
  EXPECT_EQ(poses[50].x, 0.3);
  EXPECT_EQ(poses[50].y, 0.4);
  EXPECT_EQ(poses[50].theta, 1);
  expectNoOverlap(poses);
}

TEST(PlaceRobots, NamesTheRobotsThatDoNotFit) {
  const auto place = [](std::vector<Place> places) {
    return [places] { (void)placeRobots(places, kArena, kRadius, 7); };
  };
  const dynamics::Pose here{0.3, 0.4, 0};
  const dynamics::Pose beside{0.36, 0.4, 0};
  EXPECT_THAT(place({{3, here}, {5, beside}}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("robot 5")));
  EXPECT_THAT(place({{4, dynamics::Pose{0.03, 0.4, 0}}}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("outside")));
  EXPECT_THAT(place({{4, std::nullopt}, {4, std::nullopt}}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("robot 4 is listed twice")));
  EXPECT_THAT(place(anywhere(300)), ThrowsMessage<std::invalid_argument>(HasSubstr("no room")));
}

}  // namespace
}  // namespace lab::sim::placement_test
