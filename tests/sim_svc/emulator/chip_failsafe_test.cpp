// Failures of host, program and line, with the firmware binary; all times are simulated.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

double msOf(std::uint64_t cycle) { return static_cast<double>(cycle) / kCyclesPerMs; }

/// A busy robot: a draw with STEP every 40 ms, telemetry at 50 Hz.
void driveUnderFullTelemetry(RobotOnChip& robot) {
  const dynamics::CoreSettings settings = fourPrograms({.abp = "40 ms"});
  robot.light(lightOfSlot(0));
  robot.start();
  robot.configure(settings);
  EXPECT_EQ(robot.command(wire::SetParam{wire::kTelemetryPeriod, 20}).status, wire::kOk);
  EXPECT_EQ(robot.command(wire::SetParam{wire::kStepLog, 1}).status, wire::kOk);
}

TEST(ChipFailsafe, WithoutALeaseNothingMoves) {
  RobotOnChip robot;
  robot.light(lightOfSlot(0));
  robot.start();
  robot.configure(fourPrograms());
  robot.run(3000);
  EXPECT_TRUE(robot.changes().empty());
  EXPECT_NE(robot.last<wire::Telemetry>()->flags & dynamics::kLeaseExpired, 0);
}

TEST(ChipFailsafe, AKilledHostStopsTheMotorsWithinTheLeaseAndTenMilliseconds) {
  double latest = -1e9;
  double earliest = 1e9;
  for (int i = 0; i < 40; ++i) {
    RobotOnChip robot;
    driveUnderFullTelemetry(robot);
    constexpr std::uint32_t kLeaseMs = 500;
    double heartbeat_end = 0;
    for (int beat = 0; beat < 5; ++beat) {
      robot.send(robot.order(wire::Order::kTable, kLeaseMs));
      heartbeat_end = msOf(robot.chip().receivingUntil());
      robot.run(200 + 0.37 * i);
    }
    EXPECT_NE(robot.chip().duty(), Duty{});
    robot.forget();
    robot.run(700);
    ASSERT_FALSE(robot.changes().empty());
    EXPECT_EQ(robot.changes().back().duty, Duty{});
    const double off = msOf(robot.changes().back().cycle) - heartbeat_end - kLeaseMs;
    latest = std::max(latest, off);
    earliest = std::min(earliest, off);
    EXPECT_TRUE(robot.hadEvent(wire::kLeaseOver));
    robot.forget();
    robot.run(2000);
    EXPECT_TRUE(robot.changes().empty());
  }
  EXPECT_LE(latest, 10);
  EXPECT_GE(earliest, -2);
  std::cout << "end of lease to PWM off: " << earliest << " to " << latest << " ms\n";
}

TEST(ChipFailsafe, StopIsAnsweredWithinTwentyMillisecondsUnderFullTelemetry) {
  RobotOnChip robot;
  driveUnderFullTelemetry(robot);
  double slowest_off = 0;
  double slowest_answer = 0;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(robot.command(robot.order(wire::Order::kTable)).status, wire::kOk);
    robot.run(150 + 0.131 * i, 0.131);
    robot.forget();
    ASSERT_NE(robot.chip().duty(), Duty{}) << i;
    const double sent = robot.now();
    const std::uint8_t seq =
        robot.send(wire::Stop{static_cast<std::uint8_t>(i), wire::Stop::kStop});
    robot.run(60);
    ASSERT_FALSE(robot.changes().empty());
    EXPECT_EQ(robot.changes().back().duty, Duty{});
    slowest_off = std::max(slowest_off, msOf(robot.changes().back().cycle) - sent);
    bool answered = false;
    for (const auto& ack : robot.all<wire::Ack>()) {
      if (ack.seq == seq && ack.message.type == wire::Stop::kType) {
        answered = true;
        EXPECT_EQ(ack.message.status, wire::kOk);
        slowest_answer = std::max(slowest_answer, ack.ms - sent);
      }
    }
    EXPECT_TRUE(answered) << i;
    ASSERT_EQ(robot.command(wire::Stop{0, wire::Stop::kRelease}).status, wire::kOk);
  }
  EXPECT_LE(slowest_off, 20);
  EXPECT_LE(slowest_answer, 20);
  std::cout << "first byte of STOP to PWM off: " << slowest_off
            << " ms, to the end of its answer: " << slowest_answer << " ms (of 300 phases)\n";
}

TEST(ChipFailsafe, AStopHoldsWhateverIsOrdered) {
  RobotOnChip robot;
  driveUnderFullTelemetry(robot);
  robot.command(robot.order(wire::Order::kTable));
  robot.run(500);
  robot.command(wire::Stop{9, wire::Stop::kStop});
  robot.forget();
  for (int i = 0; i < 10; ++i) {
    robot.command(robot.order(wire::Order::kTable));
    robot.run(200);
  }
  EXPECT_TRUE(robot.changes().empty());
  EXPECT_EQ(robot.last<wire::Telemetry>()->stop_id, 9);
}

TEST(ChipFailsafe, AHangingProgramIsRestartedStandsAndReportsIt) {
  RobotOnChip robot;
  driveUnderFullTelemetry(robot);
  double slowest = 0;
  for (int i = 0; i < 5; ++i) {
    robot.command(robot.order(wire::Order::kTable));
    robot.run(300 + 17.7 * i);
    ASSERT_NE(robot.chip().duty(), Duty{});
    const double hung = robot.now();
    robot.forget();
    robot.chip().hang();
    robot.run(400);
    ASSERT_FALSE(robot.changes().empty());
    EXPECT_EQ(robot.changes().back().duty, Duty{});
    slowest = std::max(slowest, msOf(robot.changes().back().cycle) - hung);
    const auto hello = robot.last<wire::Hello>();
    ASSERT_TRUE(hello.has_value());
    EXPECT_EQ(hello->reset_cause, wire::kResetWatchdog);
    EXPECT_EQ(hello->uid, kTestUid);

    // When the host sends again, the event is reported, and the robot stands until an order comes.
    robot.forget();
    robot.send(wire::GetInfo{});
    robot.run(2000);
    EXPECT_TRUE(robot.hadEvent(wire::kWatchdogRestart));
    EXPECT_TRUE(robot.changes().empty());
    EXPECT_EQ(robot.last<wire::Telemetry>()->config, 0);
    EXPECT_EQ(robot.command(robot.order(wire::Order::kTable)).status, wire::kWrongConfig);
    robot.configure(fourPrograms({.abp = "40 ms"}));
    EXPECT_TRUE(robot.changes().empty());
  }
  EXPECT_LE(slowest, 300);
  EXPECT_EQ(robot.chip().power(), ChipPower::kRunning);
  std::cout << "hang to PWM off: at most " << slowest << " ms\n";
}

TEST(ChipFailsafe, TheWatchdogDoesNotRestartAnIdleRobot) {
  RobotOnChip robot;
  robot.start();
  robot.run(10000);
  EXPECT_EQ(robot.all<wire::Hello>().size(), 1U);
  EXPECT_EQ(robot.chip().counts().resets, 0U);
}

TEST(ChipFailsafe, AResetStopsTheMotorsAtOnce) {
  RobotOnChip robot;
  driveUnderFullTelemetry(robot);
  robot.command(robot.order(wire::Order::kTable));
  robot.run(300);
  ASSERT_NE(robot.chip().duty(), Duty{});
  const double reset = robot.now();
  robot.forget();
  constexpr std::uint64_t kBootloader = 10'640'000;
  robot.chip().reset(kBootloader);
  robot.run(1500);
  ASSERT_EQ(robot.changes().size(), 1U);
  EXPECT_NEAR(msOf(robot.changes().front().cycle), reset, 0.01);
  const auto hellos = robot.all<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  EXPECT_EQ(hellos.front().message.reset_cause, wire::kResetPin);
  EXPECT_GT(hellos.front().ms - reset, 1330);
  EXPECT_EQ(robot.chip().counts().resets, 1U);
}

}  // namespace
}  // namespace lab::emulator
