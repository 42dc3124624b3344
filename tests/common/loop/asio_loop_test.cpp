// The live loop. These tests need real time and wait briefly.
#include "common/loop/asio_loop.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/loop/wall_clock.hpp"

namespace lab {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kMillisecond = 1'000;

TEST(AsioLoop, StampsWithTheWallClock) {
  const std::int64_t before = wallClock();
  const AsioLoop dut;
  const std::int64_t now = dut.now();
  EXPECT_GE(now, before);
  EXPECT_LE(now, wallClock());
  EXPECT_FALSE(dut.isVirtual());
}

/// A service that is restarted after a step of the wall clock.
TEST(AsioLoop, KeepsTheTimeOfAnotherProcess) {
  constexpr std::int64_t kStep_us = -3'600'000'000;
  const AsioLoop runner(AsioLoop().clockOffset() + kStep_us);
  const AsioLoop service(runner.clockOffset());
  EXPECT_EQ(service.clockOffset(), runner.clockOffset());
  const std::int64_t before = runner.now();
  const std::int64_t now = service.now();
  EXPECT_GE(now, before - 1);
  EXPECT_LE(now, runner.now() + 1);  // each rounds its start to 1 us
  EXPECT_LT(now, wallClock() + kStep_us / 2);
}

TEST(AsioLoop, FiresTimersInOrderAndNeverEarly) {
  AsioLoop dut;
  std::string order;
  const std::int64_t start = dut.now();
  const auto fire = [&](char name, std::int64_t after) {
    dut.at(start + after, [&order, &dut, start, name, after] {
      EXPECT_GE(dut.now(), start + after);
      order += name;
    });
  };
  fire('c', 30 * kMillisecond);
  fire('a', 10 * kMillisecond);
  fire('b', 20 * kMillisecond);
  dut.at(start + 40 * kMillisecond, [&dut] { dut.stop(); });
  dut.run();
  EXPECT_EQ(order, "abc");
}

TEST(AsioLoop, RunsSimultaneousTimersInTheOrderOfScheduling) {
  AsioLoop dut;
  std::vector<int> order;
  for (int i = 0; i < 100; ++i) dut.soon([&order, i] { order.push_back(i); });
  dut.at(0, [&] { order.push_back(100); });
  dut.soon([&dut] { dut.stop(); });
  dut.run();
  ASSERT_EQ(order.size(), 101U);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(AsioLoop, RunsSoonOnlyAfterTheRunningCallback) {
  AsioLoop dut;
  std::string order;
  dut.soon([&] {
    dut.soon([&] {
      order += "b";
      dut.stop();
    });
    order += "a";
  });
  dut.run();
  EXPECT_EQ(order, "ab");
}

TEST(AsioLoop, SkipsMissedCallsAndKeepsTheGrid) {
  constexpr std::int64_t kPeriod = 40 * kMillisecond;
  AsioLoop dut;
  const std::int64_t first = dut.now() + 5 * kMillisecond;
  std::vector<std::int64_t> steps;
  std::vector<std::int64_t> late;
  dut.every(kPeriod, first, [&] {
    steps.push_back((dut.now() - first) / kPeriod);
    late.push_back((dut.now() - first) % kPeriod);
    if (steps.size() == 1) {  // blocks for two and a half periods
      while (dut.now() < first + 5 * kPeriod / 2) {
      }
    }
    if (steps.size() == 6) dut.stop();
  });
  dut.run();
  EXPECT_GE(steps[1], 3);  // calls 1 and 2 were missed and are skipped
  EXPECT_EQ(std::adjacent_find(steps.begin(), steps.end(), std::greater_equal<>()), steps.end());
  // A timer without grid would be half a period late after the blocked call.
  EXPECT_LT(*std::min_element(late.begin() + 1, late.end()), kPeriod / 4);
}

TEST(AsioLoop, RefusesAPeriodThatIsNotPositive) {
  AsioLoop dut;
  EXPECT_THROW(dut.every(0, dut.now(), [] {}), std::invalid_argument);
}

TEST(AsioLoop, CallsBackForSignals) {
  AsioLoop dut;
  std::vector<int> signals;
  dut.onSignals({SIGUSR1, SIGUSR2}, [&](int signal) {
    signals.push_back(signal);
    if (signals.size() == 2) return dut.stop();
    std::raise(SIGUSR2);
  });
  dut.soon([] { std::raise(SIGUSR1); });
  dut.run();
  EXPECT_THAT(signals, ElementsAre(SIGUSR1, SIGUSR2));
}

TEST(AsioLoop, CallsBackAsLongAsADescriptorIsReadable) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  std::string read_letters;
  {
    AsioLoop dut;
    dut.onReadable(ends[0], [&] {  // reads one letter of several at a time
      char letter = 0;
      ASSERT_EQ(read(ends[0], &letter, 1), 1);
      read_letters += letter;
      if (letter == '.') dut.stop();
    });
    dut.soon([&] { ASSERT_EQ(write(ends[1], "abc.", 4), 4); });
    dut.run();
  }
  EXPECT_EQ(read_letters, "abc.");
  EXPECT_NE(fcntl(ends[0], F_GETFD), -1) << "the loop closed a descriptor that it does not own";
  close(ends[0]);
  close(ends[1]);
}

TEST(AsioLoop, AWatchCanBeEndedFromItsOwnCallback) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  ASSERT_EQ(write(ends[1], "ab", 2), 2);
  AsioLoop dut;
  int calls = 0;
  std::unique_ptr<AsioLoop::Watch> watch;
  watch = dut.watch(ends[0], [&] {  // "a" and "b" remain unread: it would be called repeatedly
    ++calls;
    watch.reset();
  });
  dut.at(dut.now() + 20 * kMillisecond, [&dut] { dut.stop(); });
  dut.run();
  EXPECT_EQ(calls, 1);
  close(ends[0]);
  // Another file may get the same number, so the old watch must be gone completely.
  std::array<int, 2> others{};
  ASSERT_EQ(pipe(others.data()), 0);
  ASSERT_EQ(write(others[1], "c", 1), 1);
  watch = dut.watch(others[0], [&] { calls += 100; });
  watch.reset();  // before the first call
  watch = dut.watch(others[0], [&] {
    calls += 10;
    dut.stop();
  });
  dut.run();
  EXPECT_EQ(calls, 11);
  watch.reset();
  for (const int end : {ends[1], others[0], others[1]}) close(end);
}

TEST(AsioLoop, PassesOnACallbacksException) {
  AsioLoop dut;
  dut.soon([] { throw std::runtime_error("robot on fire"); });
  EXPECT_THROW(dut.run(), std::runtime_error);
}

TEST(AsioLoop, ContinuesWhenRunAgainAfterAStop) {
  AsioLoop dut;
  int runs = 0;
  dut.every(kMillisecond, dut.now(), [&] {
    ++runs;
    dut.stop();
  });
  dut.run();
  dut.run();
  EXPECT_EQ(runs, 2);
}

}  // namespace
}  // namespace lab
