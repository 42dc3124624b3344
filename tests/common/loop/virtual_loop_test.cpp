#include "common/loop/virtual_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace lab::virtual_loop_test {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kStart = 1000;

class VirtualLoopTest : public testing::Test {
 protected:
  Loop::Callback note(const std::string& what) {
    return [this, what] { notes_.push_back(what + "@" + std::to_string(dut_.now() - kStart)); };
  }
  std::vector<std::string> notes_;
  VirtualLoop dut_{kStart};
};

TEST_F(VirtualLoopTest, StartsAtAFixedEpoch) {
  EXPECT_EQ(VirtualLoop().now(), 946'684'800'000'000);  // 2000-01-01 00:00:00 UTC
  EXPECT_TRUE(dut_.isVirtual());
}

TEST_F(VirtualLoopTest, RunsEventsInOrderOfTime) {
  dut_.at(kStart + 30, note("c"));
  dut_.at(kStart + 10, note("a"));
  dut_.at(kStart + 20, note("b"));
  dut_.run();
  EXPECT_THAT(notes_, ElementsAre("a@10", "b@20", "c@30"));
}

TEST_F(VirtualLoopTest, BreaksTiesByTheOrderOfScheduling) {
  dut_.at(kStart + 10, [this] {
    note("first")();
    dut_.at(kStart + 10, note("scheduled meanwhile"));
  });
  dut_.every(10, kStart + 10, note("tick"));
  dut_.at(kStart + 10, note("last"));
  dut_.runUntil(kStart + 10);
  EXPECT_THAT(notes_, ElementsAre("first@10", "tick@10", "last@10", "scheduled meanwhile@10"));
}

TEST_F(VirtualLoopTest, DrainsTheBusBetweenEventsBeforeTimeMovesOn) {
  dut_.drainWith(note("drain"));
  dut_.at(kStart + 10, note("a"));
  dut_.at(kStart + 10, note("b"));
  dut_.at(kStart + 20, note("c"));
  dut_.run();
  EXPECT_THAT(notes_,
              ElementsAre("drain@0", "a@10", "drain@10", "b@10", "drain@10", "c@20", "drain@20"));
}

TEST_F(VirtualLoopTest, KeepsPeriodicTimersOnTheirGrid) {
  dut_.every(20, kStart + 5, note("tick"));
  dut_.runUntil(kStart + 65);
  EXPECT_THAT(notes_, ElementsAre("tick@5", "tick@25", "tick@45", "tick@65"));
  EXPECT_EQ(dut_.now(), kStart + 65);
}

TEST_F(VirtualLoopTest, RunsOverdueEventsAtOnce) {
  dut_.runUntil(kStart + 100);
  dut_.at(kStart, note("overdue"));
  dut_.soon(note("soon"));
  dut_.runUntil(kStart + 100);
  EXPECT_THAT(notes_, ElementsAre("overdue@100", "soon@100"));
}

TEST_F(VirtualLoopTest, AdvancesTheClockWithoutEvents) {
  dut_.runUntil(kStart + 7);
  EXPECT_EQ(dut_.now(), kStart + 7);
  dut_.runUntil(kStart + 3);
  EXPECT_EQ(dut_.now(), kStart + 7);
}

TEST_F(VirtualLoopTest, StopsAfterTheEventThatCallsStopAndContinuesWhenRunAgain) {
  dut_.every(10, kStart + 10, note("tick"));
  dut_.at(kStart + 20, [this] { dut_.stop(); });
  dut_.run();
  EXPECT_THAT(notes_, ElementsAre("tick@10"));
  EXPECT_EQ(dut_.now(), kStart + 20);
  dut_.runUntil(kStart + 30);
  EXPECT_THAT(notes_, ElementsAre("tick@10", "tick@20", "tick@30"));
}

TEST_F(VirtualLoopTest, NeverRunsBackwardAfterAStop) {
  dut_.at(kStart + 10, [this] { dut_.stop(); });
  dut_.at(kStart + 20, note("later"));
  dut_.runUntil(kStart + 100);
  EXPECT_EQ(dut_.now(), kStart + 10);
  dut_.runUntil(kStart + 100);
  EXPECT_THAT(notes_, ElementsAre("later@20"));
}

TEST_F(VirtualLoopTest, AllowsCallbacksToScheduleManyEvents) {
  int calls = 0;
  dut_.every(10, kStart, [&] {
    for (int i = 0; i < 50; ++i) dut_.soon([&calls] { ++calls; });
  });
  dut_.runUntil(kStart + 99);
  EXPECT_EQ(calls, 10 * 50);
}

TEST_F(VirtualLoopTest, RefusesAPeriodThatIsNotPositive) {
  EXPECT_THROW(dut_.every(0, kStart, [] {}), std::invalid_argument);
  EXPECT_THROW(dut_.every(-1, kStart, [] {}), std::invalid_argument);
}

}  // namespace
}  // namespace lab::virtual_loop_test
