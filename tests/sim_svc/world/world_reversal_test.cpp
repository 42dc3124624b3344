#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "sim_svc/world.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim {
namespace {

TEST(WorldReversal, DrivesFortyCentimetresStraightBackAndResumesExactly) {
  // One robot meets a wall; the other one has the same draws but no wall in reach.
  WorldSettings settings = idealHardware();
  World dut(settings, robotAt(1.05, 0.45, 0));
  WorldSettings open = settings;
  open.arena = {100, 0.9};
  World free(open, robotAt(1.05, 0.45, 0));
  startAll(dut, always(abpProgram(0.03, 0.5, 0.3)));
  startAll(free, always(abpProgram(0.03, 0.5, 0.3)));
  while (!has(dut.state(0), dynamics::kReversing)) {
    ASSERT_LT(dut.timeUs(), 20 * kSecond);
    dut.step(1000);
  }
  const RobotState begun = dut.state(0);
  const dynamics::Pose turn_back = begun.pose;
  while (has(dut.state(0), dynamics::kReversing)) dut.step(1000);
  const RobotState ended = dut.state(0);
  EXPECT_EQ(ended.core.reversal_count, 1U);
  EXPECT_NEAR(ended.reversal_end - ended.reversal_start, 4.0, 1e-9);
  EXPECT_NEAR(std::hypot(ended.pose.x - turn_back.x, ended.pose.y - turn_back.y), 0.40, 3e-4)
      << "both ends are sampled within a millisecond";
  EXPECT_NEAR(ended.pose.theta, turn_back.theta, 1e-4);

  // Without the reversal, the track equals the free one, shifted by 40 cm along the heading and by
  // 4 s.
  free.advanceTo(10 * kSecond);
  dut.advanceTo(14 * kSecond);
  ASSERT_EQ(dut.state(0).core.reversal_count, 1U);
  EXPECT_EQ(dut.state(0).core.draw_count, free.state(0).core.draw_count);
  const double heading = turn_back.theta;
  EXPECT_NEAR(dut.pose(0).theta, free.pose(0).theta, 1e-9);
  EXPECT_NEAR(dut.pose(0).x + 0.4 * std::cos(heading), free.pose(0).x, 1e-4);
  EXPECT_NEAR(dut.pose(0).y + 0.4 * std::sin(heading), free.pose(0).y, 1e-4);
}

TEST(WorldReversal, HappensBeforeTheWallIsTouched) {
  World dut(idealHardware(), robotAt(0.6, 0.45, 0));
  startAll(dut, always(wheelsProgram(0.2, 0.2)));
  dut.advanceTo(60 * kSecond);
  EXPECT_GT(dut.state(0).core.reversal_count, 5U);
  EXPECT_EQ(dut.state(0).wall_contacts, 0);
}

TEST(WorldReversal, EndsAtAWallBehind) {
  // The arena is too small to drive back 40 cm, so the reversal ends when the wall behind is
  // sensed.
  WorldSettings settings = idealHardware();
  settings.arena = {0.5, 0.9};
  World dut(settings, robotAt(0.25, 0.45, 0));
  startAll(dut, always(wheelsProgram(0.1, 0.1)));
  dut.advanceTo(60 * kSecond);
  const RobotState state = dut.state(0);
  EXPECT_GT(state.core.reversal_count, 5U);
  EXPECT_LT(state.reversal_end - state.reversal_start, 3.9);
  EXPECT_EQ(state.wall_contacts, 0);
}

TEST(WorldReversal, ARobotParallelToAWallIsNotTrapped) {
  World dut(idealHardware(), robotAt(0.2, 0.06, 0));
  startAll(dut, always(wheelsProgram(0.05, 0.05)));
  dut.advanceTo(10 * kSecond);
  EXPECT_EQ(dut.state(0).core.reversal_count, 0U);
  EXPECT_NEAR(dut.pose(0).x, 0.7, 0.01);
}

TEST(WorldReversal, WhenDisabledTheWallStopsTheRobot) {
  World dut(idealHardware(), robotAt(1.0, 0.45, 0));
  dynamics::CoreSettings blind = always(wheelsProgram(0.1, 0.1));
  blind.reversal.enabled = false;
  startAll(dut, blind);
  dut.advanceTo(10 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 1.2 - 0.0375, 1e-6);
  EXPECT_TRUE(dut.state(0).contact_wall);
  EXPECT_EQ(dut.state(0).wall_contacts, 1);
  EXPECT_EQ(dut.collisions(), 0);
}

class WorldReversalFromRobots : public ::testing::Test {
 protected:
  static World headOn(bool robots_seen, ContactRule rule = ContactRule::kSlide) {
    WorldSettings settings = idealHardware();
    settings.contact = rule;
    World world(settings, {{1, dynamics::Pose{0.4, 0.45, 0}, false},
                           {2, dynamics::Pose{0.8, 0.45, 0}, false}});
    world.setReversesFromRobots(0, robots_seen);
    const Program program = wheelsProgram(0.05, 0.05);
    world.addProgram(program.hash, program.code);
    world.order(0, [&program](dynamics::RobotCore& core, std::uint32_t now_ms) {
      core.configure(now_ms, always(program));
      core.renewLease(now_ms, dynamics::RobotCore::kNoEventMs);
    });
    world.advanceTo(8 * kSecond);
    return world;
  }
};

TEST_F(WorldReversalFromRobots, RobotsAreObstaclesIfTheyAreSeen) {
  const World dut = headOn(true);
  EXPECT_EQ(dut.state(0).core.reversal_count, 1U);
  EXPECT_EQ(dut.collisions(), 0);
}

TEST_F(WorldReversalFromRobots, RobotsArePushedIfTheyAreNotSeen) {
  const World dut = headOn(false);
  EXPECT_EQ(dut.state(0).core.reversal_count, 0U);
  // 5 cm/s until they touch, then half of it.
  const double start = dut.state(0).program_start;
  const double pushed = (8 - start - (0.4 - 0.075) / 0.05) * 0.05 / 2;
  EXPECT_NEAR(dut.pose(0).x, 0.8 - 0.075 + pushed, 1e-4);
  EXPECT_NEAR(dut.pose(1).x, 0.8 + pushed, 1e-4);
  EXPECT_TRUE(dut.state(0).contact_robot);
  EXPECT_TRUE(dut.state(1).contact_robot);
  EXPECT_EQ(dut.collisions(), 1);
  EXPECT_EQ(dut.state(0).sensors.ir[0], 1023) << "the sensor still reads it";
}

TEST_F(WorldReversalFromRobots, OfRobotsThatStopAreRunIntoIfTheyAreNotSeen) {
  const World dut = headOn(false, ContactRule::kStop);
  EXPECT_EQ(dut.state(0).core.reversal_count, 0U);
  EXPECT_NEAR(dut.pose(0).x, 0.8 - 0.075, 1e-8);
  EXPECT_EQ(dut.pose(1).x, 0.8) << "nothing is pushed";
  EXPECT_TRUE(dut.state(0).contact_robot);
  EXPECT_TRUE(dut.state(1).contact_robot);
  EXPECT_FALSE(dut.state(0).contact_wall);
  EXPECT_EQ(dut.collisions(), 1);
  EXPECT_EQ(dut.state(0).sensors.ir[0], 1023) << "the sensor still reads it";
}

}  // namespace
}  // namespace lab::sim
