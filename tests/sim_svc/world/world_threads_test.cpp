// Steps on several threads.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_threads_test {
namespace {

/// What a world shows of a robot.
struct Shown {
  dynamics::Pose pose;
  dynamics::Sensors sensors;
  std::int64_t robot_contacts = 0;
  std::int64_t wall_contacts = 0;
};

/// A crowd with much contact, noise, two programs and a moving kinematic disk.
std::vector<Shown> runCrowd(std::size_t threads) {
  WorldSettings settings;
  settings.arena = {3.5, 2.6};
  settings.speed_noise = 0.004;
  settings.turn_noise = 0.1;
  settings.light_noise = 3;
  World world(settings, robots(1100));
  world.setThreads(threads);
  const StepLight light(1.7, 0.25, 0.75);
  world.setLight(&light);
  dynamics::CoreSettings table = always(abpProgram(0.05, 0.25, 5));
  table.programs[1] = always(rtpProgram(0.05, 1, 0.5)).programs[0];
  table.light.count = 2;
  table.light.bands[0] = {0, 512, 0};
  table.light.bands[1] = {512, 1024, 1};
  table.reversal.enabled = false;
  startAll(world, table);
  const std::size_t disk = world.addKinematicDisk();
  for (int frame = 0; frame < 200; ++frame) {
    world.advanceTo(frame * 40'000);
    world.moveKinematicDisk(disk, {0.5 + 0.01 * frame, 1.3});
  }
  EXPECT_GT(world.collisions(), 5000);
  std::vector<Shown> shown;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const RobotState state = world.state(i);
    shown.push_back({state.pose, state.sensors, state.robot_contacts, state.wall_contacts});
  }
  return shown;
}

TEST(WorldThreads, GiveTheSameBitsWithAnyNumber) {
  const std::vector<Shown> one = runCrowd(1);
  for (const std::size_t threads : {2U, 8U}) {
    const std::vector<Shown> more = runCrowd(threads);
    ASSERT_EQ(more.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(std::memcmp(&more[i].pose, &one[i].pose, sizeof one[i].pose), 0) << i;
      EXPECT_EQ(std::memcmp(&more[i].sensors, &one[i].sensors, sizeof one[i].sensors), 0) << i;
      EXPECT_EQ(more[i].robot_contacts, one[i].robot_contacts) << i;
      EXPECT_EQ(more[i].wall_contacts, one[i].wall_contacts) << i;
    }
  }
}

}  // namespace
}  // namespace lab::sim::world_threads_test
