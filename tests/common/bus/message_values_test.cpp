#include "common/bus/message_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>

#include "common/experiment/program_messages.hpp"
#include "common/math/saturated.hpp"

namespace lab::message_values_test {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;

robot_status_t status() {
  robot_status_t status{};
  status.utime = kNow;
  status.robots.resize(3);
  status.num_robots = 3;
  for (robot_state_t& state : status.robots) {
    state.utime = kNow;
    state.program.hash = 0xFFFF'FFFF;
    state.program.name = "abp";
    state.phase = 7;
  }
  return status;
}

template <class Message>
std::string problem(const Message& message) {
  return impossibleValue(message).value_or("");
}

TEST(MessageValues, NameFieldFoundAndExpected) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(2);
  EXPECT_EQ(problem(frame), "");
  frame.robots[1].x = 1e300;
  EXPECT_EQ(problem(frame), "robots[1].x: found 1e+300, expected -1000 to 1000");
  frame.robots[1].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(problem(frame), "robots[1].x: found nan, expected -1000 to 1000");
  frame.robots[1].x = 0;
  frame.utime = -1;
  EXPECT_EQ(problem(frame), "utime: found -1, expected 0 to 4102444800000000");
}

TEST(MessageValues, ANumberJustBeyondABoundDoesNotLookLikeTheBound) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(1);
  frame.robots[0].x = 1000.0000001;
  EXPECT_EQ(problem(frame), "robots[0].x: found 1000.0000001, expected -1000 to 1000");
  frame.robots[0].x = std::nextafter(1000.0, 2000.0);
  EXPECT_EQ(problem(frame), "robots[0].x: found 1000.0000000000001, expected -1000 to 1000");
  frame.robots[0].x = 1234.5678;
  EXPECT_EQ(problem(frame), "robots[0].x: found 1234.57, expected -1000 to 1000");
}

TEST(MessageValues, RefuseHashesAndPhasesThatNoProgramHas) {
  EXPECT_EQ(problem(status()), "");
  robot_status_t dut = status();
  dut.robots[2].program.hash = kImpossibleHash;
  EXPECT_EQ(problem(dut), "robots[2].program.hash: found -1, expected 0 to 4294967295");
  dut.robots[2].program.hash = 0x1'0000'0000;
  EXPECT_EQ(problem(dut), "robots[2].program.hash: found 4294967296, expected 0 to 4294967295");
  dut = status();
  dut.robots[2].phase = -1;
  EXPECT_EQ(problem(dut), "robots[2].phase: found -1, expected 0 to 127");
}

TEST(MessageValues, NeverRefuseAStop) {
  robot_stop_t stop{};
  stop.utime = std::numeric_limits<std::int64_t>::min();
  stop.seq = -1;
  EXPECT_EQ(problem(stop), "");
  EXPECT_FALSE(impossibleHeader("ROBOT_STOP", stop.utime, stop.seq));
  EXPECT_TRUE(impossibleHeader("ROBOT_COMMAND", stop.utime, stop.seq));
}

TEST(MessageValues, OnlyTheRobotConcernedIsRemoved) {
  robot_status_t dut = status();
  EXPECT_FALSE(removeImpossible(dut));
  dut.robots[0].robot_id = 1;
  dut.robots[1].run_time = -1;
  dut.robots[2].robot_id = 3;
  const auto found = removeImpossible(dut);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->usable);
  EXPECT_EQ(found->count, 1);
  EXPECT_EQ(found->first, "robots[1].run_time: found -1, expected 0 to 1e+10");
  ASSERT_EQ(dut.robots.size(), 2U);
  EXPECT_EQ(dut.num_robots, 2);
  EXPECT_EQ(dut.robots[1].robot_id, 3);
}

TEST(MessageValues, OnlyTheDetectionConcernedIsRemoved) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.robots.resize(2);
  frame.num_robots = 2;
  frame.unidentified.resize(2);
  frame.num_unidentified = 2;
  frame.robots[0].y = 1e9;
  frame.unidentified[1].theta = std::numeric_limits<double>::quiet_NaN();
  const auto found = removeImpossible(frame);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->count, 2);
  EXPECT_EQ(frame.num_robots, 1);
  EXPECT_EQ(frame.num_unidentified, 1);
  EXPECT_EQ(problem(frame), "");
}

TEST(MessageValues, AMessageWithAnImpossibleHeaderIsNotUsable) {
  tracked_frame_t frame{};
  frame.utime = kNow;
  frame.frame = -7;
  frame.robots.resize(1);
  frame.num_robots = 1;
  frame.robots[0].y = 1e9;
  const auto found = removeImpossible(frame);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->usable);
  EXPECT_EQ(found->count, 1);
}

TEST(Saturated, DifferencesDoNotOverflow) {
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(saturatedDifference(7, 9), -2);
  EXPECT_EQ(saturatedDifference(kLowest, 1), kLowest);
  EXPECT_EQ(saturatedDifference(kHighest, -1), kHighest);
}

TEST(Saturated, SumsDoNotOverflow) {
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(limitedSum(2, 3, 10), 5);
  EXPECT_EQ(limitedSum(2, 9, 10), 10);
  EXPECT_EQ(limitedSum(kHighest, kHighest, 10), 10);
}

TEST(Saturated, LimitsWhatACastCannotHold) {
  EXPECT_EQ(saturated<int>(1e300), std::numeric_limits<int>::max());
  EXPECT_EQ(saturated<int>(-1e300), std::numeric_limits<int>::min());
  EXPECT_EQ(saturated<int>(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(saturated<std::int64_t>(9.3e18), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(saturated<std::uint8_t>(-3.5), 0);
  EXPECT_EQ(saturated<int>(-3.5), -3);
}

}  // namespace
}  // namespace lab::message_values_test
