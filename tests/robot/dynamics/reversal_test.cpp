#include <gtest/gtest.h>

#include "robot/dynamics/robot_core.hpp"
#include "tests/robot/dynamics/core_fixture.hpp"

namespace lab::dynamics {
namespace {

constexpr uint8_t kFront = 0;
constexpr uint8_t kFrontLeft = 1;
constexpr uint8_t kRearLeft = 2;
constexpr uint8_t kRear = 3;

Sensors seeing(uint8_t sensor, uint16_t counts) {
  Sensors sensors = light(100);
  sensors.ir[sensor] = counts;
  return sensors;
}

CoreSettings driving(int32_t left, int32_t right) {
  CoreSettings settings = twoPrograms();
  settings.programs[0] = hashOf(wheelsText(left, right));
  return settings;
}

TEST(Reversal, DrivesStraightBackFortyCentimetresAndResumesExactly) {
  RobotCore dut = runningCore(0);
  RobotCore undisturbed = runningCore(0);
  dut.sense(180, seeing(kFront, 300));
  expectWheels(dut, -100000, -100000);
  EXPECT_TRUE(has(dut, kReversing));
  EXPECT_EQ(dut.report().held.left, 4002) << "the program's speeds are still reported";
  EXPECT_EQ(dut.nextEventMs(180), 4180U) << "40 cm at 10 cm/s";
  dut.sense(200, seeing(kFront, 250));
  dut.sense(220, light(100));
  dut.advanceTo(4179);
  expectWheels(dut, -100000, -100000);
  dut.advanceTo(4180);
  EXPECT_FALSE(has(dut, kReversing));
  EXPECT_EQ(dut.report().reversal_count, 1U);
  EXPECT_EQ(dut.report().reversal_start_ms, 180U);
  EXPECT_EQ(dut.report().reversal_end_ms, 4180U);
  EXPECT_EQ(dut.report().program_epoch, undisturbed.report().program_epoch);
  // From here on everything is as without the reversal, but 4000 ms later.
  for (uint32_t t = 180; t < 20000; ++t) {
    undisturbed.advanceTo(t);
    dut.advanceTo(t + 4000);
    ASSERT_EQ(dut.wheels().left, undisturbed.wheels().left) << t;
    ASSERT_EQ(dut.wheels().right, undisturbed.wheels().right) << t;
  }
}

TEST(Reversal, ContinuesARunAfterAReversalInsteadOfTumbling) {
  RobotCore dut = runningCore(0);
  dut.sense(20, light(600));
  const uint32_t run_end = dut.nextEventMs(20);
  ASSERT_GT(run_end, 40U);
  Sensors sensors = light(600);
  sensors.ir[kFront] = 200;
  dut.sense(40, sensors);
  ASSERT_TRUE(has(dut, kReversing));
  dut.advanceTo(4040);
  expectWheels(dut, 50000, 50000);
  EXPECT_EQ(dut.nextEventMs(4040), run_end + 4000);
}

TEST(Reversal, OnlyFrontSensorsReverseForwardMotion) {
  for (uint8_t sensor = 0; sensor < kIrSensors; ++sensor) {
    RobotCore dut = runningCore(0, driving(20000, 30000));
    dut.sense(20, seeing(sensor, 100));
    const bool in_front = sensor == 0 || sensor == 1 || sensor == 5;
    EXPECT_EQ(has(dut, kReversing), in_front) << int(sensor);
    if (in_front) {
      expectWheels(dut, -100000, -100000);
    }
  }
}

TEST(Reversal, OnlyRearSensorsReverseBackwardMotion) {
  for (uint8_t sensor = 0; sensor < kIrSensors; ++sensor) {
    RobotCore dut = runningCore(0, driving(-20000, 10000));
    dut.sense(20, seeing(sensor, 100));
    const bool at_rear = sensor == 2 || sensor == 3 || sensor == 4;
    EXPECT_EQ(has(dut, kReversing), at_rear) << int(sensor);
    if (at_rear) {
      expectWheels(dut, 100000, 100000);
    }
  }
}

TEST(Reversal, DoesNotStartDuringATurnOnTheSpot) {
  RobotCore dut = runningCore(0, driving(-100000, 100000));
  for (uint8_t sensor = 0; sensor < kIrSensors; ++sensor) {
    dut.sense(20U + sensor, seeing(sensor, 1000));
    EXPECT_FALSE(has(dut, kReversing));
  }
}

TEST(Reversal, NeedsMoreThanTheMargin) {
  RobotCore dut = runningCore(0);
  dut.sense(20, seeing(kFront, 8));
  EXPECT_FALSE(has(dut, kReversing));
  dut.sense(40, seeing(kFront, 9));
  EXPECT_TRUE(has(dut, kReversing));
}

TEST(Reversal, DoesNotTrapARobotThatLeavesAWall) {
  RobotCore dut = runningCore(0, driving(30000, 30000));
  dut.sense(20, seeing(kFrontLeft, 500));
  ASSERT_TRUE(has(dut, kReversing));
  dut.sense(4000, seeing(kFrontLeft, 400));
  dut.advanceTo(4020);
  ASSERT_FALSE(has(dut, kReversing));
  // The wall is still in range, but the robot is parallel to it and then leaves: no approach.
  dut.sense(4040, seeing(kFrontLeft, 404));
  dut.sense(4060, seeing(kFrontLeft, 408));
  dut.sense(4080, seeing(kFrontLeft, 300));
  EXPECT_FALSE(has(dut, kReversing));
  // Approaching the wall again, closer than the largest distance before.
  dut.sense(4100, seeing(kFrontLeft, 308));
  EXPECT_FALSE(has(dut, kReversing));
  dut.sense(4120, seeing(kFrontLeft, 309));
  EXPECT_TRUE(has(dut, kReversing));
  EXPECT_EQ(dut.report().reversal_count, 2U);
}

TEST(Reversal, TheFirstReadingAfterBootIsNotAnApproach) {
  RobotCore dut(testPrograms());
  dut.configure(0, driving(30000, 30000));
  dut.renewLease(0, 10000);
  dut.sense(20, seeing(kFront, 700));
  EXPECT_FALSE(has(dut, kReversing));
  dut.sense(40, seeing(kFront, 709));
  EXPECT_TRUE(has(dut, kReversing));
}

TEST(Reversal, EndsEarlyAtAnObstacleBehindAndResumesExactly) {
  RobotCore dut = runningCore(0);
  dut.sense(180, seeing(kFront, 300));
  dut.sense(1000, seeing(kRearLeft, 8));
  EXPECT_TRUE(has(dut, kReversing));
  dut.sense(1020, seeing(kRearLeft, 40));
  EXPECT_FALSE(has(dut, kReversing));
  EXPECT_EQ(dut.report().reversal_end_ms, 1020U);
  expectWheels(dut, 4002, 55998);
  EXPECT_EQ(dut.nextEventMs(1020), 1340U) << "320 ms of the hold remained";
}

TEST(Reversal, AnObstacleThatWasAlreadyBehindDoesNotEndIt) {
  RobotCore dut = runningCore(0);
  Sensors both = seeing(kFront, 300);
  both.ir[kRear] = 500;
  dut.sense(20, both);
  ASSERT_TRUE(has(dut, kReversing));
  both.ir[kRear] = 508;
  dut.sense(40, both);
  EXPECT_TRUE(has(dut, kReversing));
  both.ir[kRear] = 509;
  dut.sense(60, both);
  EXPECT_FALSE(has(dut, kReversing));
}

TEST(Reversal, SensorsOppositeToTheMotionDoNotEndIt) {
  RobotCore dut = runningCore(0);
  dut.sense(20, seeing(kFront, 300));
  dut.sense(40, seeing(kFront, 900));
  EXPECT_TRUE(has(dut, kReversing));
}

TEST(Reversal, AChangeOfLightStartsTheNewProgramPausedUntilTheEnd) {
  RobotCore dut = runningCore(0);
  dut.sense(20, seeing(kFront, 300));
  dut.sense(40, light(600));
  EXPECT_EQ(dut.report().slot, 1);
  EXPECT_EQ(dut.report().program_start_ms, 40U);
  EXPECT_TRUE(has(dut, kReversing));
  const WheelSpeedsUmS drawn = dut.report().held;
  const uint32_t draws = dut.report().draw_count;
  dut.advanceTo(4020);
  EXPECT_FALSE(has(dut, kReversing));
  EXPECT_EQ(dut.report().draw_count, draws);
  expectWheels(dut, drawn.left, drawn.right);
  // The reversal drew no random numbers, so the run is as long as without it.
  RobotCore free = runningCore(0);
  free.sense(40, light(600));
  EXPECT_EQ(dut.nextEventMs(4020) - 4020U, free.nextEventMs(40) - 40U);
}

TEST(Reversal, ALightWithoutAProgramEndsIt) {
  RobotCore dut = runningCore(0);
  dut.sense(20, seeing(kFront, 300));
  dut.sense(40, light(1023));
  EXPECT_FALSE(has(dut, kReversing));
  expectWheels(dut, 0, 0);
}

TEST(Reversal, AStopEndsItPermanently) {
  RobotCore dut = runningCore(0);
  dut.sense(20, seeing(kFront, 300));
  dut.stop(1000);
  expectWheels(dut, 0, 0);
  EXPECT_FALSE(has(dut, kReversing));
  EXPECT_EQ(dut.report().reversal_end_ms, 1000U);
  dut.advanceTo(10000);
  expectWheels(dut, 0, 0);
}

TEST(Reversal, AnExpiredLeaseEndsItPermanently) {
  RobotCore dut = runningCore(0);
  dut.renewLease(0, 700);
  dut.sense(20, seeing(kFront, 300));
  dut.advanceTo(5000);
  expectWheels(dut, 0, 0);
  EXPECT_EQ(dut.report().reversal_end_ms, 700U);
}

TEST(Reversal, PausesAProgramThatNeverEnds) {
  RobotCore dut = runningCore(0, driving(30000, 30000));
  dut.sense(20, seeing(kFront, 300));
  dut.advanceTo(4020);
  expectWheels(dut, 30000, 30000);
  EXPECT_EQ(dut.report().draw_count, runningCore(0, driving(30000, 30000)).report().draw_count);
}

TEST(Reversal, CanBeDisabledAndConfigured) {
  CoreSettings off = driving(30000, 30000);
  off.reversal.enabled = false;
  RobotCore blind = runningCore(0, off);
  blind.sense(20, seeing(kFront, 1000));
  EXPECT_FALSE(has(blind, kReversing));

  CoreSettings other = driving(30000, 30000);
  other.reversal.distance_um = 100000;
  other.reversal.speed_um_s = 150000;
  RobotCore dut = runningCore(0, other);
  dut.sense(20, seeing(kFront, 1000));
  expectWheels(dut, -150000, -150000);
  EXPECT_EQ(dut.nextEventMs(20), 20 + 667U);
}

TEST(Reversal, DoesNotBeginWithoutASpeed) {
  for (const int32_t speed : {0, -1, INT32_MIN}) {
    CoreSettings settings = driving(50000, 50000);
    settings.reversal.speed_um_s = speed;
    RobotCore dut = runningCore(0);
    dut.configure(10, settings);
    dut.sense(20, seeing(kFront, 0));
    dut.sense(40, seeing(kFront, 300));
    EXPECT_FALSE(has(dut, kReversing)) << speed;
    expectWheels(dut, 50000, 50000);
  }
}

}  // namespace
}  // namespace lab::dynamics
