// What programs read, and how the core interrupts and pauses them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "robot/dynamics/robot_core.hpp"
#include "tests/robot/dynamics/core_fixture.hpp"

namespace lab::dynamics {
namespace {

Sensors front(uint16_t counts) {
  Sensors sensors = light(100);
  sensors.ir[0] = counts;
  return sensors;
}

CoreSettings withoutReversals(CoreSettings settings) {
  settings.reversal.enabled = false;
  return settings;
}

/// Runs until an obstacle is near, then turns for one second.
std::vector<language::PhaseText> untilObstacle() {
  language::PhaseText run = drivingPhase("run", "5 cm/s", "", "10 s", "run");
  run.until = "ir(0) > 0.5";
  run.then = "turn";
  return {run, drivingPhase("turn", "", "1 rad/s", "1 s", "run")};
}

TEST(CorePrograms, AConditionEndsTheHoldAtTheScanThatFulfilsIt) {
  RobotCore dut = runningCore(0, withoutReversals(running(untilObstacle())));
  const uint32_t draws = dut.report().draw_count;
  dut.sense(20, front(500));
  EXPECT_EQ(dut.report().phase, 0);
  dut.sense(40, front(600));
  EXPECT_EQ(dut.report().phase, 1);
  EXPECT_TRUE(has(dut, kTumbling));
  EXPECT_EQ(dut.report().draw_count, draws + 1);
  EXPECT_EQ(dut.report().tumble_count, 1U);
  expectWheels(dut, -37500, 37500);
  EXPECT_EQ(dut.holdStartMs(), 40U);
  EXPECT_EQ(dut.nextEventMs(40), 1040U);
  dut.sense(60, front(700));
  EXPECT_EQ(dut.nextEventMs(60), 1040U) << "the turn has no condition";
  dut.advanceTo(1040);
  EXPECT_EQ(dut.report().phase, 0);
  EXPECT_EQ(dut.runTimeMs(1040), 40U);
}

TEST(CorePrograms, AHoldThatEndsAtAScanEndsBeforeIt) {
  std::vector<language::PhaseText> phases = untilObstacle();
  phases[0].next = "turn";
  phases[0].hold = "20 ms";
  RobotCore dut = runningCore(0, withoutReversals(running(phases)));
  dut.sense(20, front(600));
  EXPECT_EQ(dut.report().tumble_count, 1U) << "the turn began by itself";
  EXPECT_EQ(dut.nextEventMs(20), 1020U);
}

TEST(CorePrograms, NoConditionIsLookedAtDuringAReversal) {
  RobotCore dut = runningCore(0, running(untilObstacle()));
  dut.sense(20, front(600));
  EXPECT_TRUE(has(dut, kReversing)) << "the reversal takes precedence";
  EXPECT_EQ(dut.report().phase, 0);
  dut.sense(40, front(600));
  EXPECT_EQ(dut.report().phase, 0);
  dut.advanceTo(4020);
  ASSERT_FALSE(has(dut, kReversing));
  EXPECT_EQ(dut.report().phase, 0);
  dut.sense(4040, front(600));
  EXPECT_EQ(dut.report().phase, 1);
}

TEST(CorePrograms, TheirTimePausesDuringReversals) {
  language::PhaseText run = drivingPhase("run", "5 cm/s", "", "forever", "run");
  run.until = "phase_time >= 100 ms and time >= 100 ms";
  run.then = "turn";
  RobotCore dut =
      runningCore(0, running({run, drivingPhase("turn", "time / 1 s * 1 cm/s", "", "1 s", "run")}));
  dut.sense(80, front(600));
  ASSERT_TRUE(has(dut, kReversing));
  dut.sense(4080, light(100));
  EXPECT_EQ(dut.report().phase, 0) << "80 ms of the program";
  dut.sense(4099, light(100));
  EXPECT_EQ(dut.report().phase, 0);
  dut.sense(4100, light(100));
  EXPECT_EQ(dut.report().phase, 1);
  expectWheels(dut, 1000, 1000);
}

TEST(CorePrograms, ReadWhatTheHostWritesTheirBatteryAndTheirNumber) {
  CoreSettings settings = running({wheelPhase("clamp(sense(3), -9, 9) * 1 cm/s + id * 1 mm/s",
                                              "battery * 1 cm/s / 1 volt", "100 ms")});
  settings.robot_id = 7;
  RobotCore dut = runningCore(0, settings);
  expectWheels(dut, 7000, 0);
  dut.advanceTo(50);
  dut.setSense(3, 3 * kOne / 2);
  dut.setBattery(3700);
  expectWheels(dut, 7000, 0);
  dut.advanceTo(100);
  expectWheels(dut, 22000, 37000);
}

TEST(CorePrograms, ReadTheirOwnOdometry) {
  // After any turn it turns back within one second.
  const language::PhaseText away =
      drivingPhase("away", "5 cm/s", "uniform(-3, 3) * 1 rad/s", "700 ms", "back");
  const language::PhaseText back = drivingPhase("back", "", "-heading / 1 s", "1 s", "away");
  RobotCore dut = runningCore(0, running({away, back}));
  int32_t largest_turn = 0;
  for (uint32_t t = 1700; t < 170000; t += 1700) {
    dut.advanceTo(t);
    ASSERT_EQ(dut.report().phase, 0);
    largest_turn = std::max(largest_turn, std::abs(dut.report().held.left));
    // Below half a micrometre per second of each wheel.
    ASSERT_LT(std::abs(static_cast<int32_t>(dut.odometry().headingTurns())), 20000) << t;
    ASSERT_NEAR(dut.odometry().distanceUm(), t / 1700 * 35000, 1);
  }
  EXPECT_GT(largest_turn, 100000);
}

TEST(CorePrograms, AnUnknownProgramStandsAndSaysSo) {
  MemoryPrograms programs;
  CoreSettings settings = twoPrograms();
  settings.programs[1] = 0;
  RobotCore dut(programs);
  dut.configure(0, settings);
  dut.renewLease(0, RobotCore::kNoEventMs);
  EXPECT_FALSE(has(dut, kNoProgram)) << "none is selected yet";
  dut.sense(20, light(100));
  EXPECT_TRUE(has(dut, kNoProgram));
  EXPECT_EQ(dut.report().slot, 0);
  EXPECT_EQ(dut.report().program, 0U);
  expectWheels(dut, 0, 0);
  dut.advanceTo(100000);
  EXPECT_EQ(dut.runTimeMs(100000), 0U);
  dut.sense(100000, light(600));
  EXPECT_FALSE(has(dut, kNoProgram)) << "a slot without a program";
  dut.sense(100020, light(100));
  const uint32_t epoch = dut.report().program_epoch;
  dut.configure(100030, settings);
  EXPECT_EQ(dut.report().program_epoch, epoch);
  EXPECT_EQ(programs.add(testPrograms().code(settings.programs[0])), settings.programs[0]);
  dut.configure(100040, settings);
  EXPECT_FALSE(has(dut, kNoProgram)) << "equal settings, but now the program is there";
  EXPECT_EQ(dut.report().program, settings.programs[0]);
  EXPECT_EQ(dut.report().program_start_ms, 100040U);
}

TEST(CorePrograms, ALimitedResultSetsTheFlagAndIsCounted) {
  RobotCore dut = runningCore(0, running({wheelPhase("1 cm/s / light", "1 cm/s", "100 ms")}));
  EXPECT_FALSE(has(dut, kSaturated));
  dut.sense(10, light(0));
  dut.advanceTo(100);
  EXPECT_TRUE(has(dut, kSaturated));
  EXPECT_EQ(dut.report().saturation_count, 1U);
  expectWheels(dut, kMaxWheelUmS, 10000);
  dut.sense(110, light(500));
  dut.advanceTo(200);
  EXPECT_FALSE(has(dut, kSaturated));
}

TEST(CorePrograms, AConditionThatIsLimitedSetsTheFlagOnceForEachHold) {
  language::PhaseText run = drivingPhase("run", "5 cm/s", "", "1 s", "run");
  run.until = "1 / light < 0";
  RobotCore dut = runningCore(0, withoutReversals(running({run})));
  dut.sense(20, light(0));
  EXPECT_TRUE(has(dut, kSaturated));
  dut.sense(40, light(0));
  EXPECT_EQ(dut.report().saturation_count, 1U);
  dut.advanceTo(1000);
  EXPECT_FALSE(has(dut, kSaturated));
}

TEST(CorePrograms, HoldsOfNoTimeFollowEachOtherAtOnce) {
  const language::PhaseText pick =
      drivingPhase("pick", "1 cm/s", "", "(light - light) * 1 s", "go");
  RobotCore dut = runningCore(0, running({pick, drivingPhase("go", "2 cm/s", "", "1 s", "pick")}));
  dut.advanceTo(0);
  EXPECT_EQ(dut.report().phase, 1);
  expectWheels(dut, 20000, 20000);
  EXPECT_EQ(dut.nextEventMs(0), 1000U);
  dut.advanceTo(1000);
  expectWheels(dut, 20000, 20000);
}

TEST(CorePrograms, ARestartBeginsWithTheFirstPhaseAndFreshState) {
  language::PhaseText count = drivingPhase("count", "n * 1 cm/s", "", "100 ms");
  count.set = {{"n", "min(n + 1, 9)"}};
  language::ProgramText text = programText({count});
  text.state = {{"n", "0"}};
  CoreSettings settings = twoPrograms();
  settings.programs[0] = hashOf(text);
  RobotCore dut = runningCore(0, settings);
  dut.advanceTo(450);
  expectWheels(dut, 50000, 50000);
  dut.stop(460);
  EXPECT_EQ(dut.report().program, 0U);
  EXPECT_EQ(dut.report().phase, 0);
  dut.clearStop(470);
  expectWheels(dut, 10000, 10000);
  EXPECT_EQ(dut.odometry().distanceUm(), 0U);
}

}  // namespace
}  // namespace lab::dynamics
