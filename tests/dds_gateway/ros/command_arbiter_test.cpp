#include "dds_gateway/ros/command_arbiter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lab::gateway {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kTimeout = 400'000;
constexpr std::int64_t kMs = 1000;
constexpr dds::WriterId kAnna = 11;
constexpr dds::WriterId kBert = 12;

ros::Twist forward(double v) {
  ros::Twist twist{};
  twist.linear.x = v;
  return twist;
}

robot_order_t tableOrder() {
  robot_order_t order{};
  order.mode = robot_order_t::TABLE;
  order.bands.resize(1);
  order.num_bands = 1;
  return order;
}

robot_command_t labCommand(std::int8_t mode, std::vector<std::int32_t> robots) {
  robot_order_t order{};
  order.mode = mode;
  order.robot_ids = std::move(robots);
  order.num_robots = static_cast<std::int32_t>(order.robot_ids.size());
  robot_command_t command{};
  command.orders = {order};
  command.num_orders = 1;
  return command;
}

class CommandArbiterTest : public ::testing::Test {
 protected:
  CommandArbiter dut_{{1, 2, 3}, {0.27, 0.075}, kTimeout};
  std::int64_t now_ = 1'000'000'000;

  void advanceTime(std::int64_t ms) {
    for (std::int64_t i = 0; i < ms; i += 20) {
      now_ += 20 * kMs;
      dut_.tick(now_);
    }
  }
};

TEST_F(CommandArbiterTest, DrivesAtOnceAndRepeats) {
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kTaken);
  const auto sent = dut_.due(now_);
  ASSERT_THAT(sent, SizeIs(1));
  ASSERT_THAT(sent[0].orders, SizeIs(1));
  EXPECT_EQ(sent[0].num_orders, 1);
  EXPECT_EQ(sent[0].orders[0].mode, robot_order_t::DRIVE);
  EXPECT_EQ(sent[0].orders[0].wheel_left, 0.1);
  EXPECT_THAT(sent[0].orders[0].robot_ids, ElementsAre(1));
  EXPECT_EQ(sent[0].orders[0].num_robots, 1);
  EXPECT_GT(sent[0].lease_ms, 0);
  EXPECT_THAT(dut_.due(now_ + 50 * kMs), IsEmpty());
  const auto again = dut_.due(now_ + 100 * kMs);
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_EQ(again[0].seq, sent[0].seq) << "the same order";
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.2), now_ + 105 * kMs), Answer::kTaken);
  EXPECT_THAT(dut_.due(now_ + 110 * kMs), IsEmpty()) << "fifty messages a second are enough";
  const auto other = dut_.due(now_ + 120 * kMs);
  ASSERT_THAT(other, SizeIs(1));
  EXPECT_GT(other[0].seq, sent[0].seq);
}

TEST_F(CommandArbiterTest, RobotsTravelInOneMessage) {
  dut_.drive(1, kAnna, forward(0.1), now_);
  dut_.drive(2, kBert, forward(0.1), now_);
  dut_.drive(3, kBert, forward(0.2), now_);
  const auto sent = dut_.due(now_);
  ASSERT_THAT(sent, SizeIs(1));
  ASSERT_THAT(sent[0].orders, SizeIs(2));
  EXPECT_THAT(sent[0].orders[0].robot_ids, ElementsAre(1, 2));
  EXPECT_THAT(sent[0].orders[1].robot_ids, ElementsAre(3));
}

TEST_F(CommandArbiterTest, RefusesInvalidNumbers) {
  EXPECT_EQ(dut_.drive(1, kAnna, forward(std::nan("")), now_), Answer::kNotFinite);
  EXPECT_EQ(dut_.drive(1, kAnna, forward(std::numeric_limits<double>::infinity()), now_),
            Answer::kNotFinite);
  EXPECT_THAT(dut_.due(now_), IsEmpty());
  EXPECT_EQ(dut_.drive(1, kAnna, forward(5), now_), Answer::kClamped);
  EXPECT_DOUBLE_EQ(dut_.due(now_).at(0).orders[0].wheel_left, 0.27);
}

TEST_F(CommandArbiterTest, RefusesUnknownRobots) {
  EXPECT_EQ(dut_.drive(4, kAnna, forward(0.1), now_), Answer::kNoRobot);
  EXPECT_EQ(dut_.command({2, 99}, kAnna, tableOrder(), now_), Answer::kNoRobot);
  EXPECT_EQ(dut_.held(), 1U) << "robot 2 obeys";
}

TEST_F(CommandArbiterTest, TheFirstPublisherHoldsTheRobotUntilItIsSilent) {
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kTaken);
  for (int i = 0; i < 20; ++i) {
    advanceTime(60);
    EXPECT_EQ(dut_.drive(1, kBert, forward(-0.2), now_), Answer::kOwned);
    EXPECT_EQ(dut_.command({1}, kBert, tableOrder(), now_), Answer::kOwned);
    EXPECT_EQ(dut_.release({1}, kBert, now_), Answer::kOwned);
    EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kTaken);
  }
  EXPECT_EQ(dut_.drive(2, kBert, forward(-0.2), now_), Answer::kTaken) << "another robot";
  now_ += kTimeout;
  EXPECT_EQ(dut_.drive(1, kBert, forward(-0.2), now_), Answer::kOwned);
  now_ += 1;
  EXPECT_EQ(dut_.drive(1, kBert, forward(-0.2), now_), Answer::kTaken);
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kOwned);
}

TEST_F(CommandArbiterTest, ASilentPublisherStopsTheRobotAndThenReleasesIt) {
  dut_.drive(1, kAnna, forward(0.1), now_);
  static_cast<void>(dut_.due(now_));
  advanceTime(400);
  EXPECT_EQ(dut_.silences(), 0);
  static_cast<void>(dut_.due(now_));
  advanceTime(20);
  EXPECT_EQ(dut_.silences(), 1);
  const auto stand = dut_.due(now_);
  ASSERT_THAT(stand, SizeIs(1));
  EXPECT_EQ(stand[0].orders[0].mode, robot_order_t::STAND);
  advanceTime(4'980);
  EXPECT_EQ(dut_.held(), 1U);
  EXPECT_THAT(dut_.due(now_), SizeIs(1)) << "it stands, and goes on standing";
  advanceTime(40);
  EXPECT_EQ(dut_.held(), 0U);
  const auto last = dut_.due(now_);
  ASSERT_THAT(last, SizeIs(1));
  EXPECT_LE(last[0].lease_ms, 1) << "the lab's next command counts";
  EXPECT_THAT(dut_.due(now_ + 1'000'000), IsEmpty());
  EXPECT_EQ(dut_.silences(), 1);
}

TEST_F(CommandArbiterTest, AProgramStaysInForceWithoutRepetition) {
  EXPECT_EQ(dut_.command({1, 3}, kAnna, tableOrder(), now_), Answer::kTaken);
  const auto first = dut_.due(now_);
  ASSERT_THAT(first, SizeIs(1));
  EXPECT_THAT(first[0].orders.at(0).robot_ids, ElementsAre(1, 3));
  advanceTime(60'000);
  const auto later = dut_.due(now_);
  ASSERT_THAT(later, SizeIs(1));
  EXPECT_EQ(later[0].seq, first[0].seq) << "it is not begun anew";
  EXPECT_EQ(dut_.command({3}, kBert, tableOrder(), now_), Answer::kTaken) << "long silent";
  const auto both = dut_.due(now_ + 500'000);
  ASSERT_THAT(both, SizeIs(2));
  EXPECT_EQ(both[0].seq, first[0].seq);
  EXPECT_THAT(both[0].orders.at(0).robot_ids, ElementsAre(1));
}

TEST_F(CommandArbiterTest, ManyProgramsNeverMakeABurst) {
  CommandArbiter many({1, 2, 3, 4, 5, 6, 7, 8, 9}, {0.27, 0.075}, kTimeout);
  for (std::int32_t id = 1; id <= 9; ++id) many.command({id}, kAnna, tableOrder(), now_);
  std::size_t sent = 0;
  for (int i = 0; i < 5; ++i) {
    const std::size_t now = many.due(now_ + i * 20 * kMs).size();
    EXPECT_LE(now, 5U);
    sent += now;
  }
  EXPECT_EQ(sent, 9U);
}

TEST_F(CommandArbiterTest, AStopOutranksAll) {
  dut_.drive(1, kAnna, forward(0.1), now_);
  dut_.command({2}, kAnna, tableOrder(), now_);
  robot_stop_t stop{};
  stop.seq = 5;
  dut_.take(stop, now_);
  EXPECT_EQ(dut_.held(), 0U);
  EXPECT_THAT(dut_.due(now_), IsEmpty());
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kStopped);
  // Messages of the stop may be lost; then the robots' status reports it.
  robot_status_t status{};
  status.robots.resize(1);
  status.robots[0].robot_id = 1;
  status.robots[0].flags = robot_state_t::FLAG_STOPPED;
  dut_.take(status);
  now_ += 10'000'000;
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kStopped);
  stop.clear = 1;
  dut_.take(stop, now_);
  status.robots[0].flags = 0;
  dut_.take(status);
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kTaken);
}

TEST_F(CommandArbiterTest, AStopOfOneRobotLeavesTheOthers) {
  dut_.drive(1, kAnna, forward(0.1), now_);
  dut_.drive(2, kAnna, forward(0.1), now_);
  robot_stop_t stop{};
  stop.robot_ids = {2};
  stop.num_robots = 1;
  dut_.take(stop, now_);
  EXPECT_EQ(dut_.held(), 1U);
}

TEST_F(CommandArbiterTest, TheLabThatHoldsARobotOutranksRos) {
  dut_.take(labCommand(robot_order_t::TABLE, {1, 2, 3}), now_);
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kTaken);
  dut_.take(labCommand(robot_order_t::STAND, {1, 2, 3}), now_);
  EXPECT_EQ(dut_.held(), 0U);
  EXPECT_THAT(dut_.due(now_), IsEmpty()) << "no word against the lab's";
  EXPECT_EQ(dut_.drive(1, kAnna, forward(0.1), now_), Answer::kLabHolds);
  dut_.take(labCommand(robot_order_t::DRIVE, {2}), now_);
  EXPECT_EQ(dut_.drive(2, kAnna, forward(0.1), now_), Answer::kLabHolds);
  now_ += 2'000'000;
  EXPECT_EQ(dut_.drive(2, kAnna, forward(0.1), now_), Answer::kTaken) << "that lab is gone";
}

TEST_F(CommandArbiterTest, ReleasesARobotOnRequest) {
  dut_.command({1}, kAnna, tableOrder(), now_);
  static_cast<void>(dut_.due(now_));
  EXPECT_EQ(dut_.release({1, 2}, kAnna, now_), Answer::kTaken);
  const auto last = dut_.due(now_);
  ASSERT_THAT(last, SizeIs(1));
  EXPECT_EQ(last[0].orders.at(0).mode, robot_order_t::STAND);
  EXPECT_THAT(last[0].orders.at(0).robot_ids, ElementsAre(1));
  EXPECT_EQ(dut_.held(), 0U);
}

}  // namespace
}  // namespace lab::gateway
