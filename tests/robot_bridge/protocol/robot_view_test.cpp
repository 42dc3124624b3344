#include "robot_bridge/protocol/robot_view.hpp"

#include <gtest/gtest.h>

namespace lab::bridge {
namespace {

class RobotViewTest : public testing::Test {
 protected:
  void telemetry(std::uint32_t t_ms, std::uint16_t flags = 0, std::uint8_t skipped = 0) {
    wire::Telemetry message;
    message.t_ms = t_ms;
    message.flags = flags;
    message.slot = 0;
    message.program_epoch = epoch;
    seq = static_cast<std::uint8_t>(seq + 1 + skipped);
    dut.update(message, seq);
  }
  void state(std::uint32_t t_ms = 0) {
    wire::State message;
    message.t_ms = t_ms;
    message.program_epoch = epoch;
    message.program = 77;
    message.reversal_count = reversals;
    message.reversal_start_ms = reversal_start;
    message.reversal_end_ms = reversal_end;
    message.tumble_count = tumbles;
    dut.update(message);
  }
  void counters(std::uint32_t t_ms, std::uint32_t run_time_ms) {
    wire::Counters message;
    message.t_ms = t_ms;
    message.run_time_ms = run_time_ms;
    dut.update(message);
  }

  RobotView dut;
  std::uint8_t seq = 0;
  std::uint16_t epoch = 0;
  std::uint16_t reversals = 0;
  std::uint32_t reversal_start = 0;
  std::uint32_t reversal_end = 0;
  std::uint16_t tumbles = 0;
};

TEST_F(RobotViewTest, NeedsTelemetryAndTheMatchingState) {
  EXPECT_FALSE(dut.snapshot());
  telemetry(50);
  EXPECT_FALSE(dut.snapshot());
  state();
  telemetry(100);
  ASSERT_TRUE(dut.snapshot());
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 100U);
  EXPECT_TRUE(dut.takeUpdateFlag());
  EXPECT_FALSE(dut.takeUpdateFlag());
}

TEST_F(RobotViewTest, ATelemetryWhoseStateWasLostWaitsForTheNextState) {
  state();
  telemetry(50);
  epoch = 1;
  telemetry(100);
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 50U);
  state();
  telemetry(150);
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 150U);
  EXPECT_EQ(dut.snapshot()->program_epoch, 1U);
}

TEST_F(RobotViewTest, AReversalWhoseStateWasLostWaitsToo) {
  state();
  telemetry(50, dynamics::kReversing);
  EXPECT_FALSE(dut.snapshot());
  reversals = 1;
  reversal_start = 40;
  state();
  telemetry(100, dynamics::kReversing);
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 100U);
  EXPECT_EQ(dut.snapshot()->reversal_count, 1U);
  telemetry(150);  // the reversal is over, but its STATE was lost
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 100U);
  reversal_end = 140;
  state();
  telemetry(200);
  EXPECT_EQ(dut.snapshot()->telemetry.t_ms, 200U);
}

TEST_F(RobotViewTest, UnwrapsTheCounts) {
  for (std::uint32_t i = 0; i < 200; ++i) {
    epoch = static_cast<std::uint16_t>(i * 1000);
    tumbles = static_cast<std::uint16_t>(i * 3000);
    state();
    telemetry(i * 50);
    EXPECT_EQ(dut.snapshot()->program_epoch, i * 1000);
    EXPECT_EQ(dut.snapshot()->tumble_count, i * 3000);
  }
}

TEST_F(RobotViewTest, CountsLostTelemetry) {
  state();
  telemetry(0);
  telemetry(50);
  telemetry(200, 0, 2);
  EXPECT_EQ(dut.telemetryLost(), 2);
  for (int i = 0; i < 300; ++i) telemetry(250);
  EXPECT_EQ(dut.telemetryLost(), 2) << "the number wraps around";
  dut.reset();
  seq = 77;
  telemetry(0);
  EXPECT_EQ(dut.telemetryLost(), 2) << "a restart is no loss";
}

TEST_F(RobotViewTest, CountsRunsAndTumblesBetweenTheReports) {
  state();
  counters(0, 5000);
  telemetry(0);
  telemetry(50);
  EXPECT_DOUBLE_EQ(dut.snapshot()->run_time_ms, 5050);
  telemetry(100, dynamics::kTumbling);
  EXPECT_DOUBLE_EQ(dut.snapshot()->run_time_ms, 5075);
  EXPECT_EQ(dut.snapshot()->tumble_count, 1U);
  telemetry(150, dynamics::kTumbling);
  telemetry(200);
  EXPECT_DOUBLE_EQ(dut.snapshot()->run_time_ms, 5100);
  counters(210, 5110);
  telemetry(250);
  EXPECT_DOUBLE_EQ(dut.snapshot()->run_time_ms, 5150);
  tumbles = 1;
  state();
  telemetry(300);
  EXPECT_EQ(dut.snapshot()->tumble_count, 1U);
}

TEST_F(RobotViewTest, RunTimeAndTumblesNeverDecrease) {
  state();
  counters(0, 0);
  telemetry(0);
  telemetry(50, dynamics::kTumbling);  // counts half of the interval as run
  counters(60, 3);                     // the true value is lower
  telemetry(100, dynamics::kTumbling);
  EXPECT_DOUBLE_EQ(dut.snapshot()->run_time_ms, 25);
  state();  // was sent before the tumble began and does not count it
  telemetry(150, dynamics::kTumbling);
  EXPECT_EQ(dut.snapshot()->tumble_count, 1U);
}

TEST_F(RobotViewTest, UnwrapsTheEpochOfSteps) {
  epoch = 0xFFFF;
  state();
  wire::Step step;
  step.draw_count = 1;
  step.program_epoch = 0xFFFF;
  dut.update(step);
  step.draw_count = 2;
  step.program_epoch = 0;  // the STATE with this epoch comes later
  dut.update(step);
  step.draw_count = 5;
  dut.update(step);
  const auto steps = dut.takeSteps();
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].program_epoch, 0xFFFFU);
  EXPECT_EQ(steps[1].program_epoch, 0x10000U);
  EXPECT_EQ(dut.stepsLost(), 2);
  EXPECT_TRUE(dut.takeSteps().empty());
}

}  // namespace
}  // namespace lab::bridge
