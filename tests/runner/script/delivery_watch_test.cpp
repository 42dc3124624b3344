#include "runner/script/delivery_watch.hpp"

#include <gtest/gtest.h>

namespace lab::runner {
namespace {

constexpr std::int64_t kInstance = 7;
constexpr std::int64_t kSeq = 3;

program_id_t abp() {
  program_id_t program{};
  program.hash = 77;
  program.name = "abp";
  return program;
}

DeliveryWatch watching(const std::optional<program_id_t>& expected, std::size_t robots = 1) {
  experiment_event_t step{};
  step.commanded_utime = 1000;
  return {step, kInstance, kSeq, expected, robots};
}

light_status_t shown(std::int64_t utime, std::int64_t seq = kSeq) {
  light_status_t status{};
  status.command_instance = kInstance;
  status.command_seq = seq;
  status.first_shown_utime = utime;
  return status;
}

/// One robot that runs `program` since `start`, sampled at `utime`.
robot_status_t running(std::int32_t id, const program_id_t& program, std::int64_t start,
                       std::int64_t utime) {
  robot_status_t status{};
  robot_state_t robot{};
  robot.robot_id = id;
  robot.program = program;
  robot.program_start_utime = start;
  robot.utime = utime;
  status.robots.push_back(robot);
  status.num_robots = 1;
  return status;
}

TEST(DeliveryWatch, IsCompleteWhenTheLightIsShownAndEveryRobotActed) {
  DeliveryWatch dut = watching(abp());
  dut.take(running(1, program_id_t{}, 0, 1500));
  EXPECT_FALSE(dut.complete());
  dut.take(shown(2000));
  EXPECT_FALSE(dut.complete());
  dut.take(running(1, program_id_t{}, 0, 2010));
  EXPECT_FALSE(dut.complete());
  dut.take(running(1, abp(), 2015, 2030));
  EXPECT_TRUE(dut.complete());
  const experiment_event_t event = dut.event();
  EXPECT_EQ(event.presented_utime, 2000);
  EXPECT_EQ(event.first_acted_utime, 2015);
  EXPECT_EQ(event.last_acted_utime, 2015);
  EXPECT_EQ(event.robots_acted, 1);
  EXPECT_EQ(event.robots_expected, 1);
}

TEST(DeliveryWatch, WaitsForTheSlowestRobot) {
  DeliveryWatch dut = watching(abp(), 2);
  dut.take(shown(2000));
  EXPECT_FALSE(dut.complete()) << "no robot has reported yet";
  dut.take(running(1, abp(), 2010, 2020));
  EXPECT_FALSE(dut.complete());
  dut.take(running(2, program_id_t{}, 0, 2020));
  EXPECT_FALSE(dut.complete());
  dut.take(running(2, abp(), 2040, 2060));
  EXPECT_TRUE(dut.complete());
  EXPECT_EQ(dut.event().first_acted_utime, 2010);
  EXPECT_EQ(dut.event().last_acted_utime, 2040);
}

TEST(DeliveryWatch, DoesNotExpectARobotThatAlreadyRunsTheProgram) {
  DeliveryWatch dut = watching(abp());
  dut.take(running(1, abp(), 500, 1500));
  dut.take(shown(2000));
  dut.take(running(1, abp(), 500, 2010));
  EXPECT_TRUE(dut.complete());
  EXPECT_EQ(dut.event().robots_expected, 0);
}

TEST(DeliveryWatch, IgnoresTheLightOfAnotherCommand) {
  DeliveryWatch dut = watching(std::nullopt);
  dut.take(shown(2000, kSeq - 1));
  EXPECT_FALSE(dut.complete());
  EXPECT_EQ(dut.event().presented_utime, 0);
}

light_seen_t seen(std::int64_t utime, std::int8_t sync) {
  light_seen_t seen{};
  seen.utime = utime;
  seen.sync = sync;
  return seen;
}

TEST(DeliveryWatch, IsSeenInTheFirstPictureWithTheChangedPatch) {
  DeliveryWatch dut = watching(std::nullopt);
  dut.expectSeen();
  light_status_t first = shown(2000);
  first.utime = 2000;
  first.sync = 1;
  dut.take(first);
  EXPECT_FALSE(dut.complete());
  dut.take(seen(1990, 1));
  dut.take(seen(2005, -1));
  dut.take(seen(2010, 0));
  EXPECT_FALSE(dut.complete()) << "none of these shows the new light";
  dut.take(seen(2015, 1));
  dut.take(seen(2025, 1));
  EXPECT_TRUE(dut.complete());
  EXPECT_EQ(dut.event().seen_utime, 2015);
}

TEST(DeliveryWatch, IsNotSeenAfterThePatchHasChangedTwice) {
  DeliveryWatch dut = watching(std::nullopt);
  light_status_t first = shown(2000);
  first.utime = 2000;
  first.sync = 1;
  dut.take(first);
  dut.take(seen(1'002'100, 1));
  EXPECT_EQ(dut.event().seen_utime, 0);
}

TEST(DeliveryWatch, IsNotSeenByALaterChangeOfThePatch) {
  DeliveryWatch dut = watching(std::nullopt);
  dut.expectSeen();
  light_status_t later = shown(2000);  // the first frame's status was lost
  later.utime = 900'000;
  later.sync = 0;
  dut.take(later);
  dut.take(seen(2015, 0));
  EXPECT_TRUE(dut.complete());
  EXPECT_EQ(dut.event().seen_utime, 0);
}

TEST(DeliveryWatch, ExpectsNoRobotToActUnderNonUniformLight) {
  DeliveryWatch dut = watching(std::nullopt);
  dut.take(running(1, program_id_t{}, 0, 2010));
  dut.take(shown(2000));
  EXPECT_TRUE(dut.complete());
}

}  // namespace
}  // namespace lab::runner
