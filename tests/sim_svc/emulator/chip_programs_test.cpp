// The path light -> converter -> program -> pulse width in the firmware binary.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>

#include "robot/dynamics/motor.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

using dynamics::dutyForSpeed;
using dynamics::kMaxWheelUmS;

/// Time of the last change of the motors [ms].
double lastChangeMs(const RobotOnChip& robot) {
  return static_cast<double>(robot.changes().back().cycle) / kCyclesPerMs;
}

RobotOnChip& running(RobotOnChip& robot, const dynamics::CoreSettings& settings,
                     std::uint16_t light) {
  robot.light(light);
  robot.start();
  robot.command(wire::SetParam{wire::kStepLog, 1});
  robot.configure(settings);
  robot.command(robot.order(wire::Order::kTable));
  return robot;
}

TEST(ChipPrograms, TheLightBandSelectsTheProgram) {
  dynamics::CoreSettings settings = fourPrograms();
  constexpr std::int32_t kSpeeds[][2] = {{100000, -50000}, {-270000, 270000}, {529, 530},
                                         {0, 81234},       {-1060, -530},     {0, 0}};
  for (const auto& speeds : kSpeeds) {
    settings.programs[0] = hashOf(wheelsText(speeds[0], speeds[1]));
    RobotOnChip robot;
    running(robot, settings, lightOfSlot(0));
    robot.run(50);
    EXPECT_EQ(robot.chip().duty().left, dutyForSpeed(speeds[0], kMaxWheelUmS)) << speeds[0];
    EXPECT_EQ(robot.chip().duty().right, dutyForSpeed(speeds[1], kMaxWheelUmS)) << speeds[1];
  }
}

TEST(ChipPrograms, DirectDrivingTurnsTheCorrectWheelsInTheCorrectDirection) {
  RobotOnChip robot;
  robot.start();
  robot.configure(fourPrograms());
  wire::Order drive = robot.order(wire::Order::kDrive);
  drive.left_um_s = 135000;
  drive.right_um_s = -54000;
  EXPECT_EQ(robot.command(drive).status, wire::kOk);
  robot.run(5);
  EXPECT_EQ(robot.chip().duty(), (Duty{128, -51}));
  EXPECT_EQ(robot.command(robot.order(wire::Order::kStand)).status, wire::kOk);
  robot.run(5);
  EXPECT_EQ(robot.chip().duty(), Duty{});
}

TEST(ChipPrograms, CalibrationChangesTheDuties) {
  firmware::Settings calibrated;
  calibrated.uid = kTestUid;
  calibrated.left = {900000, 20};
  calibrated.right = {1100000, 35};
  RobotOnChip robot({}, storeWith(calibrated));
  robot.start();
  robot.configure(fourPrograms());
  wire::Order drive = robot.order(wire::Order::kDrive);
  drive.left_um_s = drive.right_um_s = 100000;
  robot.command(drive);
  robot.run(5);
  EXPECT_EQ(robot.chip().duty().left, dutyForSpeed(100000, kMaxWheelUmS, calibrated.left));
  EXPECT_EQ(robot.chip().duty().right, dutyForSpeed(100000, kMaxWheelUmS, calibrated.right));
  EXPECT_NE(robot.chip().duty().left, robot.chip().duty().right);
}

/// Allowance for rounding to milliseconds and for the time of starting a program, of its first
/// evaluation and of setting the motors.
constexpr double kLookMs = 4;

// For every draw of every program, the motors do what STEP reports, at the reported time.
TEST(ChipPrograms, EveryHoldOfEveryProgramReachesTheMotors) {
  for (unsigned slot = 0; slot < 4; ++slot) {
    RobotOnChip robot;
    running(robot, fourPrograms(), lightOfSlot(slot));
    const double offset_ms = [&] {  // host time when the robot's clock was 0
      robot.send(wire::Ping{});
      const double end = static_cast<double>(robot.chip().receivingUntil()) / kCyclesPerMs;
      robot.run(60);
      const auto pong = *robot.last<wire::Pong>();
      return end - pong.t_ms - pong.t_us / 1000.0;
    }();
    robot.run(20000);
    const auto steps = robot.all<wire::Step>();
    ASSERT_GT(steps.size(), 30U);
    std::size_t change = 0;
    Duty now{};
    for (const auto& [ms, seq, step] : steps) {
      if (step.slot == dynamics::kNoSlot) continue;  // it stands until the first scan
      ASSERT_EQ(step.slot, slot);
      const double begins = step.t_ms + offset_ms;
      if (step.duration_ms < 5) continue;  // too short for the sampling
      for (; change < robot.changes().size() &&
             static_cast<double>(robot.changes()[change].cycle) / kCyclesPerMs < begins + kLookMs;
           ++change) {
        now = robot.changes()[change].duty;
      }
      const Duty expected{dutyForSpeed(step.left_um_s, kMaxWheelUmS),
                          dutyForSpeed(step.right_um_s, kMaxWheelUmS)};
      ASSERT_EQ(now, expected) << "slot " << slot << " draw " << step.draw_count;
    }
  }
}

TEST(ChipPrograms, AChangeOfLightSwitchesTheProgramWithinOneSensorPeriod) {
  dynamics::CoreSettings settings = fourPrograms();
  // Uses only one sensor, because a change between the conversions of two would be spread over two
  // scans.
  settings.light.reading = dynamics::kFrontLight;
  RobotOnChip robot;
  running(robot, settings, lightOfSlot(0));
  Random random(11);
  unsigned slot = 0;
  double longest = 0;
  double shortest = 1e9;
  for (int i = 0; i < 200; ++i) {
    robot.run(230 + 40 * random.uniform(), 1);
    const unsigned next = (slot + 1 + random.next() % 3) % 4;
    robot.forget();
    const double changed = robot.now();
    robot.light(lightOfSlot(next));
    robot.run(120, 1);
    ASSERT_FALSE(robot.changes().empty()) << "from " << slot << " to " << next;
    const double first = static_cast<double>(robot.changes().front().cycle) / kCyclesPerMs;
    const auto steps = robot.all<wire::Step>();
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps.back().message.slot, next);
    longest = std::max(longest, first - changed);
    shortest = std::min(shortest, first - changed);
    slot = next;
  }
  // One period until the next scan, 1.6 ms for the scan, and the time of processing and draw.
  EXPECT_LE(longest, settings.sensor_period_ms + 1.6 + kLookMs);
  EXPECT_LT(shortest, settings.sensor_period_ms / 2.0);
  std::cout << "light to wheels: " << shortest << " to " << longest << " ms\n";
}

TEST(ChipPrograms, HysteresisWorksAtTheEdgeOfABand) {
  RobotOnChip robot;
  running(robot, fourPrograms(), 250);
  robot.run(300);
  EXPECT_EQ(robot.last<wire::Telemetry>()->slot, 0);
  robot.light(256 + 7);
  robot.run(300);
  EXPECT_EQ(robot.last<wire::Telemetry>()->slot, 0);
  robot.light(256 + 8);
  robot.run(300);
  EXPECT_EQ(robot.last<wire::Telemetry>()->slot, 1);
}

TEST(ChipPrograms, AWallAheadStartsAReversal) {
  dynamics::CoreSettings settings = fourPrograms();
  settings.reversal.enabled = true;
  settings.reversal.distance_um = 100000;
  settings.programs[0] = hashOf(wheelsText(50000, 50000));
  RobotOnChip robot;
  running(robot, settings, lightOfSlot(0));
  robot.run(500);
  EXPECT_EQ(robot.chip().duty(), (Duty{47, 47}));
  robot.ir(0, 400);
  robot.run(30);
  EXPECT_EQ(robot.chip().duty(), (Duty{-94, -94}));
  const double begun = lastChangeMs(robot);
  robot.ir(0, 0);
  robot.run(1200);
  EXPECT_EQ(robot.chip().duty(), (Duty{47, 47}));
  EXPECT_NEAR(lastChangeMs(robot) - begun, 1000, 2);
  EXPECT_EQ(robot.last<wire::State>()->reversal_count, 1);
}

}  // namespace
}  // namespace lab::emulator
