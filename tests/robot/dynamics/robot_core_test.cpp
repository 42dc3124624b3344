#include "robot/dynamics/robot_core.hpp"

#include <gtest/gtest.h>

#include "tests/robot/dynamics/core_fixture.hpp"

namespace lab::dynamics {
namespace {

TEST(RobotCore, BootsStandingWithoutALease) {
  RobotCore dut(testPrograms());
  dut.sense(0, light(100));
  dut.advanceTo(10000);
  expectWheels(dut, 0, 0);
  EXPECT_TRUE(has(dut, kLeaseExpired));
  EXPECT_TRUE(has(dut, kUnconfigured));
  EXPECT_EQ(dut.report().slot, kNoSlot);
  EXPECT_EQ(dut.nextEventMs(10000), 10000 + RobotCore::kNoEventMs);
}

TEST(RobotCore, NeedsSettingsLeaseAndLightToMove) {
  RobotCore dut(testPrograms());
  dut.seed(42);
  dut.configure(0, twoPrograms());
  expectWheels(dut, 0, 0);
  dut.renewLease(0, 1000);
  expectWheels(dut, 0, 0);
  EXPECT_TRUE(has(dut, kNoLightBand));
  dut.sense(20, light(100));
  expectWheels(dut, 4002, 55998);
  EXPECT_EQ(dut.report().slot, 0);
  EXPECT_EQ(dut.report().program, twoPrograms().programs[0]);
  EXPECT_EQ(dut.report().program_start_ms, 20U);
}

TEST(RobotCore, DrawsAtTheEndOfEachHoldWhateverTheCallTimes) {
  RobotCore often = runningCore(0);
  RobotCore seldom = runningCore(0);
  for (uint32_t t = 0; t <= 2100; ++t) {
    often.advanceTo(t);
  }
  seldom.advanceTo(2100);
  EXPECT_EQ(often.nextEventMs(2100), 2500U);
  EXPECT_EQ(seldom.nextEventMs(2100), 2500U);
  expectWheels(often, -31773, 91773);
  expectWheels(seldom, -31773, 91773);
  EXPECT_EQ(seldom.report().draw_count, often.report().draw_count);
}

TEST(RobotCore, ChangesExactlyAtTheEventAndNotBefore) {
  RobotCore dut = runningCore(0);
  dut.advanceTo(499);
  expectWheels(dut, 4002, 55998);
  dut.advanceTo(500);
  expectWheels(dut, 50181, 9819);
}

TEST(RobotCore, WorksAcrossTheWrapOfTheClock) {
  const uint32_t t0 = 0xFFFFFF00U;
  RobotCore dut = runningCore(t0);
  dut.advanceTo(t0 + 499);
  expectWheels(dut, 4002, 55998);
  EXPECT_EQ(dut.nextEventMs(t0 + 499), t0 + 500);
  dut.advanceTo(t0 + 500);
  expectWheels(dut, 50181, 9819);
}

TEST(RobotCore, ALightSwitchStartsTheOtherProgramWithAFreshDraw) {
  RobotCore dut = runningCore(0);
  const uint32_t epoch = dut.report().program_epoch;
  dut.sense(700, light(511));
  EXPECT_EQ(dut.report().program_epoch, epoch);
  dut.sense(720, light(512));
  EXPECT_EQ(dut.report().slot, 1);
  EXPECT_EQ(dut.report().program_epoch, epoch + 1);
  EXPECT_EQ(dut.report().program_start_ms, 720U);
  expectWheels(dut, 50000, 50000);
  dut.sense(740, light(950));
  EXPECT_EQ(dut.report().slot, kNoSlot);
  EXPECT_EQ(dut.report().program, 0U);
  EXPECT_EQ(dut.report().program_epoch, epoch + 2);
  expectWheels(dut, 0, 0);
  EXPECT_TRUE(has(dut, kNoLightBand));
}

TEST(RobotCore, TwoBandsOfOneSlotAreOneProgram) {
  CoreSettings settings = twoPrograms();
  settings.light.bands[1].slot = 0;
  RobotCore dut = runningCore(0, settings);
  const uint32_t epoch = dut.report().program_epoch;
  dut.sense(20, light(600));
  EXPECT_EQ(dut.report().program_epoch, epoch);
}

TEST(RobotCore, TheStopLatchTakesPrecedenceUntilItIsCleared) {
  RobotCore dut = runningCore(0);
  dut.stop(100);
  expectWheels(dut, 0, 0);
  dut.renewLease(110, 500);
  CoreSettings other = twoPrograms();
  other.programs[0] = hashOf(abpText("2 cm/s", "0.5 s", "3 rad/s"));
  dut.configure(120, other);
  dut.driveWheels(130, 10000, 10000);
  dut.sense(140, light(600));
  dut.runPrograms(150);
  expectWheels(dut, 0, 0);
  EXPECT_TRUE(has(dut, kStopped));
  EXPECT_EQ(dut.report().slot, kNoSlot);
  dut.clearStop(200);
  EXPECT_FALSE(has(dut, kStopped));
  EXPECT_EQ(dut.report().slot, 1) << "selected by the light while it stood";
  EXPECT_EQ(dut.report().program_start_ms, 200U);
}

TEST(RobotCore, StandsWhenTheLeaseExpiresAndRestartsWhenItIsRenewed) {
  RobotCore dut = runningCore(0);
  dut.renewLease(0, 700);
  EXPECT_EQ(dut.nextEventMs(600), 500U);
  dut.advanceTo(650);
  EXPECT_EQ(dut.nextEventMs(650), 700U);
  const uint32_t epoch = dut.report().program_epoch;
  dut.advanceTo(5000);
  expectWheels(dut, 0, 0);
  EXPECT_TRUE(has(dut, kLeaseExpired));
  EXPECT_EQ(dut.report().program_epoch, epoch + 1);
  EXPECT_EQ(dut.report().program_start_ms, 700U) << "it stands from the time of expiry on";
  dut.renewLease(5000, 700);
  EXPECT_FALSE(has(dut, kLeaseExpired));
  EXPECT_EQ(dut.report().program_epoch, epoch + 2);
  expectWheels(dut, 56997, 3003);
}

TEST(RobotCore, RenewingTheLeaseInTimeChangesNothing) {
  RobotCore dut = runningCore(0);
  const uint32_t epoch = dut.report().program_epoch;
  for (uint32_t t = 0; t <= 2100; t += 100) {
    dut.renewLease(t, 300);
  }
  expectWheels(dut, -31773, 91773);
  EXPECT_EQ(dut.report().program_epoch, epoch);
}

TEST(RobotCore, ALeaseThatEndsTogetherWithAHoldEndsFirst) {
  RobotCore dut = runningCore(0);
  dut.renewLease(0, 500);
  const uint32_t draws = dut.report().draw_count;
  dut.advanceTo(500);
  expectWheels(dut, 0, 0);
  EXPECT_EQ(dut.report().draw_count, draws + 1) << "standing, without a draw of the program";
}

TEST(RobotCore, EqualSettingsChangeNothingAndOthersRestartTheProgram) {
  RobotCore dut = runningCore(0);
  const uint32_t epoch = dut.report().program_epoch;
  dut.configure(100, twoPrograms());
  expectWheels(dut, 4002, 55998);
  EXPECT_EQ(dut.report().program_epoch, epoch);
  CoreSettings other = twoPrograms();
  other.programs[0] = hashOf(abpText("3 cm/s", "0.2 s", "3 rad/s"));
  dut.configure(100, other);
  EXPECT_EQ(dut.report().program_epoch, epoch + 1);
  expectWheels(dut, 50181, 9819);
  EXPECT_EQ(dut.nextEventMs(100), 300U);
}

TEST(RobotCore, DrivesTheWheelsDirectlyAndReturnsToThePrograms) {
  RobotCore dut = runningCore(0);
  dut.driveWheels(100, 12345, -300000);
  expectWheels(dut, 12345, -270000);
  EXPECT_TRUE(has(dut, kDriven));
  EXPECT_TRUE(has(dut, kSaturated));
  EXPECT_EQ(dut.report().program, 0U);
  EXPECT_EQ(dut.report().slot, kNoSlot);
  const uint32_t epoch = dut.report().program_epoch;
  dut.driveWheels(200, 12345, -300000);
  dut.sense(220, light(600));
  EXPECT_EQ(dut.report().program_epoch, epoch);
  expectWheels(dut, 12345, -270000);
  dut.runPrograms(300);
  EXPECT_EQ(dut.report().slot, 1);
  EXPECT_FALSE(has(dut, kDriven));
}

TEST(RobotCore, ClampsSpeedsBeyondTheLimitAndReportsIt) {
  CoreSettings settings = twoPrograms();
  settings.programs[0] = hashOf(abpText("3 cm/s", "0.5 s", "26 rad/s"));
  RobotCore dut = runningCore(0, settings);
  int clamped = 0;
  for (uint32_t t = 0; t < 100000; t += 500) {
    dut.advanceTo(t);
    ASSERT_LE(std::abs(dut.wheels().left), kMaxWheelUmS);
    ASSERT_LE(std::abs(dut.wheels().right), kMaxWheelUmS);
    const bool at_limit =
        std::abs(dut.wheels().left) == kMaxWheelUmS || std::abs(dut.wheels().right) == kMaxWheelUmS;
    ASSERT_EQ(has(dut, kSaturated), at_limit);
    clamped += at_limit ? 1 : 0;
  }
  EXPECT_GT(clamped, 100);
  EXPECT_EQ(dut.report().saturation_count, static_cast<uint32_t>(clamped));
}

TEST(RobotCore, ReportsTumbles) {
  RobotCore dut = runningCore(0);
  dut.sense(10, light(600));
  EXPECT_FALSE(has(dut, kTumbling));
  dut.advanceTo(dut.nextEventMs(10));
  EXPECT_TRUE(has(dut, kTumbling));
  EXPECT_EQ(dut.wheels().left, -dut.wheels().right);
}

TEST(RobotCore, StandsOnCommand) {
  RobotCore dut = runningCore(0);
  dut.stand(100);
  expectWheels(dut, 0, 0);
  EXPECT_EQ(dut.report().program, 0U);
  dut.sense(120, light(600));
  expectWheels(dut, 0, 0);
  dut.runPrograms(200);
  EXPECT_EQ(dut.report().slot, 1);
}

TEST(RobotCore, CountsTumblesAndTheTimeInRunsWithoutReversals) {
  RobotCore dut = runningCore(0);
  dut.sense(10, light(600));
  EXPECT_EQ(dut.runTimeMs(10), 10U) << "a program of one phase always runs";
  const uint32_t run_end = dut.nextEventMs(10);
  ASSERT_GT(run_end, 30U);
  Sensors sensors = light(600);
  sensors.ir[0] = 100;
  dut.sense(30, sensors);
  EXPECT_EQ(dut.runTimeMs(1000), 30U) << "a reversal does not count as a run";
  dut.advanceTo(4030);
  EXPECT_EQ(dut.runTimeMs(4035), 35U);
  dut.advanceTo(run_end + 4000);
  EXPECT_EQ(dut.report().tumble_count, 1U);
  EXPECT_EQ(dut.runTimeMs(run_end + 4300), run_end) << "a tumble does not count as a run";
  dut.advanceTo(run_end + 4500);
  EXPECT_EQ(dut.runTimeMs(run_end + 4510), run_end + 10);
  dut.stop(run_end + 4510);
  EXPECT_EQ(dut.runTimeMs(run_end + 9999), run_end + 10);
}

TEST(RobotCore, AdvancesByOneEventSoThatEveryDrawCanBeRecorded) {
  RobotCore all = runningCore(0);
  RobotCore one = runningCore(0);
  Rng rng(42);
  const ProgramBytes program = testPrograms().find(twoPrograms().programs[0]);
  const MachineInputs inputs;
  Machine machine;
  machine.start(program.code, program.size, inputs, rng);
  uint32_t start = 0;
  do {
    const PhaseResult hold = machine.next(inputs, rng);
    expectWheels(one, hold.left_um_s, hold.right_um_s);
    EXPECT_EQ(one.holdStartMs(), start);
    EXPECT_EQ(one.holdDurationMs(), hold.duration_ms);
    EXPECT_EQ(one.rng().digest(), rng.digest());
    start += hold.duration_ms;
  } while (one.advanceOne(10200));
  all.advanceTo(10200);
  EXPECT_EQ(one.record().draw_count, all.record().draw_count);
  EXPECT_EQ(one.holdStartMs(), 10000U);
  EXPECT_FALSE(one.advanceOne(10499));
  EXPECT_TRUE(one.advanceOne(10500));
}

TEST(RobotCore, FlagsAndRecordEqualTheReport) {
  RobotCore dut = runningCore(0);
  dut.advanceTo(1234);
  dut.stop(1300);
  EXPECT_EQ(dut.report().flags, dut.flags());
  EXPECT_EQ(dut.report().program_epoch, dut.record().program_epoch);
  EXPECT_EQ(dut.holdDurationMs(), kEndless);
}

}  // namespace
}  // namespace lab::dynamics
