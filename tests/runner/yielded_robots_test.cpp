#include "runner/yielded_robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace lab::runner {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

robot_command_t commandOf(std::int8_t mode, std::vector<std::int32_t> robots,
                          std::int32_t lease_ms) {
  robot_order_t order{};
  order.mode = mode;
  order.robot_ids = std::move(robots);
  order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
  robot_command_t command{};
  command.lease_ms = lease_ms;
  command.orders = {order};
  command.num_orders = 1;
  return command;
}

TEST(YieldedRobots, TheLightTableYieldsWhileTheLeaseRuns) {
  YieldedRobots dut;
  const robot_command_t table = commandOf(robot_order_t::TABLE, {1, 2, 3}, 1000);
  EXPECT_THAT(dut.without(table, 0).orders[0].robot_ids, ElementsAre(1, 2, 3));
  dut.take(commandOf(robot_order_t::DRIVE, {2}, 500), 1'000'000);
  EXPECT_TRUE(dut.contains(2, 1'499'999));
  const robot_command_t left = dut.without(table, 1'499'999);
  EXPECT_THAT(left.orders[0].robot_ids, ElementsAre(1, 3));
  EXPECT_EQ(left.orders[0].num_robots, 2);
  EXPECT_FALSE(dut.contains(2, 1'500'000));
  EXPECT_THAT(dut.without(table, 1'500'000).orders[0].robot_ids, ElementsAre(1, 2, 3));
}

TEST(YieldedRobots, StandAndDriveDoNotYield) {
  YieldedRobots dut;
  dut.take(commandOf(robot_order_t::DRIVE, {1}, 500), 0);
  for (const std::int8_t mode : {robot_order_t::STAND, robot_order_t::DRIVE}) {
    EXPECT_THAT(dut.without(commandOf(mode, {1}, 1000), 1).orders[0].robot_ids, ElementsAre(1));
  }
}

TEST(YieldedRobots, TheLatestLeaseApplies) {
  YieldedRobots dut;
  dut.take(commandOf(robot_order_t::TABLE, {1}, 2000), 0);
  dut.take(commandOf(robot_order_t::STAND, {1}, 1), 100'000);
  EXPECT_FALSE(dut.contains(1, 101'000)) << "the shorter lease is over";
  dut.take(commandOf(robot_order_t::STAND, {1}, -5), 200'000);
  EXPECT_FALSE(dut.contains(1, 200'000));
  EXPECT_THAT(dut.without(commandOf(robot_order_t::TABLE, {}, 1), 0).orders[0].robot_ids,
              IsEmpty());
}

}  // namespace
}  // namespace lab::runner
