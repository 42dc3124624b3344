// Processing time and memory that the firmware binary leaves unused, measured after every
// instruction.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <string>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

constexpr double kLongestInterruptsOffUs = 40;  // two bytes at 500000 baud
constexpr int kLeastHeadRoom = 32;              // bytes never used by the stack
constexpr double kHighestLoad = 0.5;

/// Maximum load: short draws with STEP, telemetry at 50 Hz, changing light and walls, and a host
/// that sends all kinds of messages, with an order five times a second.
void exercise(RobotOnChip& robot, int seconds) {
  dynamics::CoreSettings settings = fourPrograms({"30 ms", "30 ms", "30 ms", "17 1/s", "500 ms"});
  settings.reversal.enabled = true;
  settings.reversal.distance_um = 5000;
  robot.start();
  Random random(17);
  for (int i = 0; i < seconds * 5; ++i) {
    if (i % 25 == 0) {
      robot.configure(settings);
      robot.command(wire::SetParam{wire::kTelemetryPeriod, 20});
      robot.command(wire::SetParam{wire::kStepLog, 1});
      robot.command(wire::SetParam{wire::kGainLeft, 1000000 + i});
      robot.command(robot.order(wire::Order::kStand));
      robot.command(wire::Commit{}, 2000);
      robot.command(wire::SetSeed{1, static_cast<std::uint32_t>(i)});
      robot.send(wire::GetInfo{});
      robot.send(wire::GetParam{wire::kUid});
    }
    robot.send(robot.order(wire::Order::kTable, 1000));
    robot.send(wire::Ping{1, 2});
    if (i % 40 == 39) robot.command(wire::Stop{1, wire::Stop::kStop});
    if (i % 40 == 1) robot.command(wire::Stop{2, wire::Stop::kRelease});
    robot.light(static_cast<std::uint16_t>(random.next() % 1024));
    robot.ir(static_cast<unsigned>(random.next() % 6),
             static_cast<std::uint16_t>(random.next() % 1024));
    robot.run(200);
  }
}

TEST(ChipLimits, InterruptsStackAndLoadStayWithinLimitsUnderMaximumLoad) {
  ChipSettings settings;
  settings.profile = true;
  RobotOnChip robot(settings);
  exercise(robot, 20);
  const ChipCounts& counts = robot.chip().counts();
  const double off_us = static_cast<double>(counts.longest_interrupts_off) / (kChipHz / 1e6);
  const double load =
      1 - static_cast<double>(counts.cycles_asleep) / static_cast<double>(counts.cycles_run);
  std::cout << "interrupts off: at most " << off_us
            << " us; stack: " << robot.chip().stackHeadRoom() << " bytes never used; load "
            << 100 * load << " %\n";
  EXPECT_GT(off_us, 1);
  EXPECT_LE(off_us, kLongestInterruptsOffUs);
  EXPECT_GE(robot.chip().stackHeadRoom(), kLeastHeadRoom);
  EXPECT_GT(load, 0.01);
  EXPECT_LE(load, kHighestLoad);

  // The robot's own measurement with a RAM pattern agrees, except where the stack happened to write
  // the same value as the pattern.
  const auto reported = robot.last<wire::Counters>();
  ASSERT_TRUE(reported.has_value());
  EXPECT_NEAR(reported->stack_left * 8, robot.chip().stackHeadRoom(), 24);
  EXPECT_EQ(reported->bytes_overrun, 0);
  EXPECT_EQ(counts.bytes_overrun, 0U);
}

TEST(ChipLimits, AFullLineInBothDirectionsLosesNothing) {
  RobotOnChip robot;
  robot.start();
  robot.command(wire::SetParam{wire::kTelemetryPeriod, 10});
  robot.forget();
  int sent = 0;
  while (robot.now() < 10000) {
    while (static_cast<double>(robot.chip().receivingUntil()) < (robot.now() + 5) * kCyclesPerMs) {
      robot.send(wire::SetSeed{7, static_cast<std::uint32_t>(sent)});
      ++sent;
    }
    robot.run(4);
  }
  robot.run(2500);  // the next COUNTERS
  const auto acks = robot.all<wire::Ack>();
  EXPECT_GT(sent, 1800);
  EXPECT_EQ(robot.chip().counts().bytes_overrun, 0U);
  const auto counters = robot.last<wire::Counters>();
  ASSERT_TRUE(counters.has_value());
  EXPECT_EQ(counters->bytes_overrun, 0);
  EXPECT_EQ(counters->frames_bad, 0);
  // Answers may be dropped while the line to the host is full, but all frames must be received.
  EXPECT_EQ(counters->frames_received, sent + 2);  // and those of start() and above
  EXPECT_GT(acks.size(), 100U);
}

/// Cycles awake per second with holds of this length.
double awake(const std::string& hold, int log) {
  ChipSettings settings;
  settings.profile = true;
  RobotOnChip robot(settings);
  robot.start();
  robot.configure(fourPrograms({.abp = hold}));
  robot.light(lightOfSlot(0));
  robot.command(robot.order(wire::Order::kTable));
  robot.command(wire::SetParam{wire::kStepLog, log});
  robot.command(wire::SetParam{wire::kTelemetryPeriod, 0});
  robot.run(1000);
  const ChipCounts before = robot.chip().counts();
  robot.run(10000);
  const ChipCounts after = robot.chip().counts();
  return static_cast<double>((after.cycles_run - before.cycles_run) -
                             (after.cycles_asleep - before.cycles_asleep)) /
         10;
}

TEST(ChipLimits, BeginningAHoldTakesNoMoreThanItIsCharged) {
  // The evaluation: two pushed numbers, a parameter, a draw, a hold, a phase.
  const std::uint32_t hash = fourPrograms({.abp = "20 ms"}).programs[0];
  const unsigned charged =
      dynamics::blockCost(testPrograms().code(hash).data() + 3) + 256U * dynamics::kHoldOverhead;
  // The line carries at most 100 STEPs a second, whatever the holds.
  const double cycles = (awake("20 ms", 0) - awake("10 s", 0)) / 50;
  std::cout << "a hold takes " << cycles << " cycles, with its STEP "
            << (awake("20 ms", 1) - awake("10 s", 1)) / 50 << "; " << charged << " are charged\n";
  EXPECT_LE(cycles, charged);
  EXPECT_GE(3 * cycles, charged);
}

}  // namespace
}  // namespace lab::emulator
