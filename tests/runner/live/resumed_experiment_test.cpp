#include "runner/live/resumed_experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/experiment/experiment_file.hpp"

namespace lab::runner {
namespace {

Experiment threeRobots() {
  return parseExperiment(R"(
fileversion = 1
name = "three"
duration_s = 10
program = "stand"
[[robots]]
id = 1
count = 3
[programs.stand]
model = "stand"
)",
                         "three");
}

tracked_pose_t at(double x, double y) {
  tracked_pose_t pose{};
  pose.x = x;
  pose.y = y;
  pose.theta = 1;
  return pose;
}

TEST(ResumedExperiment, PlacesTheRobotsAtTheirLastPoses) {
  const Experiment resumed = resumedExperiment(threeRobots(), {{2, at(0.3, 0.4)}}, 1);
  ASSERT_TRUE(resumed.robots[1].start);
  EXPECT_EQ(resumed.robots[1].start->x, 0.3);
  EXPECT_EQ(resumed.robots[1].start->theta, 1);
  EXPECT_FALSE(resumed.robots[0].start) << "never seen: placed at random";
}

TEST(ResumedExperiment, UsesAnotherSeedAtEachRestart) {
  const Experiment original = threeRobots();
  const std::uint64_t first = resumedExperiment(original, {}, 1).seed;
  EXPECT_NE(first, original.seed);
  EXPECT_NE(first, resumedExperiment(original, {}, 2).seed);
}

TEST(ResumedExperiment, SeparatesPosesThatOverlapByNoise) {
  const Experiment resumed = resumedExperiment(
      threeRobots(), {{1, at(0.500, 0.4)}, {2, at(0.573, 0.4)}, {3, at(0.001, 0.899)}}, 1);
  const auto& robots = resumed.robots;
  EXPECT_GE(
      std::hypot(robots[1].start->x - robots[0].start->x, robots[1].start->y - robots[0].start->y),
      0.075);
  EXPECT_NEAR(robots[0].start->x, 0.499, 1e-3);
  EXPECT_NO_THROW(static_cast<void>(parseExperiment(writeExperiment(resumed), "resumed")));
}

}  // namespace
}  // namespace lab::runner
