#include <gmock/gmock.h>

#include <map>
#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware::device_reports_test {
namespace {

wire::SetParam param(uint8_t id, int32_t value) {
  wire::SetParam message;
  message.id = id;
  message.value = value;
  return message;
}

TEST(Telemetry, IsSentAtItsPeriodWithoutGaps) {
  for (int32_t period : {40, 50, 200}) {
    RobotOnBench robot;
    startPrograms(robot, 60000);
    robot.command(param(wire::kTelemetryPeriod, period));
    robot.heard().clear();
    robot.run(4000);
    std::vector<uint8_t> seqs;
    for (const Heard& heard : robot.heard()) {
      if (heard.frame.type == wire::Telemetry::kType) seqs.push_back(heard.frame.seq);
    }
    EXPECT_NEAR(static_cast<double>(seqs.size()), 4000.0 / period, 1.01) << period;
    for (std::size_t i = 1; i < seqs.size(); ++i) {
      EXPECT_EQ(seqs[i], static_cast<uint8_t>(seqs[i - 1] + 1));
    }
  }
}

TEST(Telemetry, WithPeriodZeroIsNotSent) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  EXPECT_EQ(robot.command(param(wire::kTelemetryPeriod, 0)).status, wire::kOk);
  robot.heard().clear();
  robot.run(2000);
  EXPECT_TRUE(robot.all<wire::Telemetry>().empty());
  EXPECT_NEAR(static_cast<double>(robot.all<wire::Counters>().size()), 2, 1);
}

TEST(Telemetry, ContainsSensorsAndMotion) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.sensors().light_front = 300;
  robot.sensors().light_back = 301;
  for (uint16_t i = 0; i < 6; ++i) robot.sensors().ir[i] = static_cast<uint16_t>(1018 + i);
  robot.run(150);
  const wire::Telemetry telemetry = robot.last<wire::Telemetry>();
  const uint16_t expected[8] = {300, 301, 1018, 1019, 1020, 1021, 1022, 1023};
  EXPECT_THAT(telemetry.sensors, testing::ElementsAreArray(expected));
  EXPECT_EQ(telemetry.slot, 0);
  EXPECT_EQ(telemetry.phase, 0);
}

TEST(State, IsSentAtEachChangeBeforeTheTelemetryThatShowsIt) {
  RobotOnBench robot;
  startPrograms(robot, 600000);
  std::map<uint16_t, bool> told;
  uint16_t light = 100;
  for (int i = 0; i < 60; ++i) {
    light = light == 100 ? 700 : 100;
    robot.sensors().light_front = robot.sensors().light_back = light;
    robot.run(static_cast<uint32_t>(90 + i));
  }
  ASSERT_GT(robot.device().core().report().program_epoch, 60U);
  int shown = 0;
  for (const Heard& heard : robot.heard()) {
    wire::State state;
    wire::Telemetry telemetry;
    if (wire::unpack(heard.frame, state)) told[state.program_epoch] = true;
    if (wire::unpack(heard.frame, telemetry)) {
      EXPECT_TRUE(told.count(telemetry.program_epoch) == 1) << telemetry.program_epoch;
      ++shown;
    }
  }
  EXPECT_GT(shown, 60);
}

TEST(State, IsRepeatedFourTimesASecond) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.run(100);
  robot.heard().clear();
  robot.run(5000);
  EXPECT_NEAR(static_cast<double>(robot.all<wire::State>().size()), 20, 1);
  const dynamics::CoreReport report = robot.device().core().report();
  const wire::State state = robot.last<wire::State>();
  EXPECT_EQ(state.program_epoch, static_cast<uint16_t>(report.program_epoch));
  EXPECT_EQ(state.program_start_ms, report.program_start_ms);
  EXPECT_EQ(state.program, twoPrograms().programs[0]);
}

TEST(State, ReportsReversals) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.run(100);
  robot.sensors().ir[0] = robot.sensors().ir[1] = robot.sensors().ir[5] = 0;
  robot.run(100);
  robot.heard().clear();
  robot.sensors().ir[0] = 500;
  robot.run(60);
  ASSERT_EQ(robot.device().core().report().reversal_count, 1U);
  EXPECT_EQ(robot.last<wire::State>().reversal_count, 1);
  EXPECT_EQ(robot.last<wire::State>().reversal_start_ms,
            robot.device().core().report().reversal_start_ms);
}

// The STEPs equal the draws of a separate core with the same seed, light and times.
TEST(Steps, AreTheDrawsOfTheCore) {
  for (const uint16_t light : std::initializer_list<uint16_t>{100, 700}) {
    RobotOnBench robot;
    robot.boot();
    dynamics::CoreSettings settings = twoPrograms();
    language::ProgramText fast = rtpText("5 cm/s", "33 1/s", "0.5 s");
    fast.phases[1].hold = "20 ms";  // and runs of 0 ms among them
    settings.programs[1] = hashOf(fast);
    robot.sensors().light_front = robot.sensors().light_back = light;
    robot.configure(settings);
    wire::SetSeed seed;
    seed.low = 7;
    robot.command(seed);
    robot.heard().clear();
    const uint32_t draws_before = robot.device().core().report().draw_count;
    robot.send(robot.order(wire::Order::kTable, 1U << 30));
    robot.run(30000);

    dynamics::Rng rng(7);
    const std::vector<uint8_t>& code = testPrograms().code(settings.programs[light == 100 ? 0 : 1]);
    const dynamics::MachineInputs inputs;
    dynamics::Machine machine;
    machine.start(code.data(), static_cast<uint8_t>(code.size()), inputs, rng);
    const std::vector<wire::Step> steps = robot.all<wire::Step>();
    ASSERT_GT(steps.size(), 50U);
    uint32_t at = steps[0].t_ms;
    uint32_t draw = draws_before + 1;
    std::size_t next = 0;
    while (next < steps.size()) {
      const dynamics::PhaseResult hold = machine.next(inputs, rng);
      if (steps[next].draw_count == draw) {  // else it was lost, as the gap shows
        EXPECT_EQ(steps[next].t_ms, at);
        EXPECT_EQ(steps[next].left_um_s, hold.left_um_s);
        EXPECT_EQ(steps[next].right_um_s, hold.right_um_s);
        EXPECT_EQ(steps[next].duration_ms, hold.duration_ms);
        EXPECT_EQ(steps[next].rng, rng.digest());
        EXPECT_EQ(steps[next].phase, machine.phase());
        ++next;
      }
      at += hold.duration_ms;
      ++draw;
    }
    EXPECT_EQ(draw - draws_before - 1, steps.size()) << "none was lost";
    robot.run(1000);
    EXPECT_EQ(robot.last<wire::Counters>().frames_dropped, 0);
  }
}

TEST(Steps, BeyondTheLinesCapacityAreCountedAndLeaveAGap) {
  RobotOnBench robot;
  robot.boot();
  dynamics::CoreSettings settings = twoPrograms();
  settings.programs[0] = hashOf(abpText("6 cm/s", "3 ms", "3 rad/s"));
  robot.configure(settings);
  robot.command(param(wire::kTelemetryPeriod, 10));  // exceeds the line's capacity by itself
  robot.command(robot.order(wire::Order::kTable, 60000));
  robot.heard().clear();
  const wire::Counters before = [&] {
    robot.run(1500);
    return robot.last<wire::Counters>();
  }();
  robot.heard().clear();
  robot.run(10000);
  const std::vector<wire::Step> steps = robot.all<wire::Step>();
  uint32_t missing = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_GT(steps[i].draw_count, steps[i - 1].draw_count);
    missing += steps[i].draw_count - steps[i - 1].draw_count - 1;
  }
  EXPECT_GT(missing, 2500U);
  const wire::Counters after = robot.last<wire::Counters>();
  EXPECT_GT(after.frames_dropped - before.frames_dropped, 2500);
  // Each kind of report is still sent.
  EXPECT_GT(steps.size(), 100U);
  EXPECT_GT(robot.all<wire::Telemetry>().size(), 150U);
  EXPECT_GT(robot.all<wire::State>().size(), 30U);
  EXPECT_GT(robot.all<wire::Counters>().size(), 8U);
}

TEST(Steps, AreNotSentWhenDisabled) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.command(param(wire::kStepLog, 0));
  robot.heard().clear();
  robot.run(3000);
  EXPECT_TRUE(robot.all<wire::Step>().empty());
  robot.command(param(wire::kStepLog, 1));
  robot.run(3000);
  EXPECT_FALSE(robot.all<wire::Step>().empty());
}

TEST(Events, BeyondTheQueueAreLostAndLeaveAGapInTheNumbers) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.run(1000);
  robot.heard().clear();
  wire::Stop stop;
  for (int i = 0; i < 10; ++i) {
    stop.action = i % 2 == 0 ? wire::Stop::kStop : wire::Stop::kRelease;
    stop.id = static_cast<uint8_t>(i);
    robot.send(stop);
  }
  robot.run(2000);
  const std::vector<wire::Event> events = robot.all<wire::Event>();
  ASSERT_EQ(events.size(), 4U) << "the queue holds four";
  EXPECT_EQ(events[3].number, events[0].number + 3);
  robot.heard().clear();
  robot.send(stop);
  stop.action = wire::Stop::kStop;
  robot.send(stop);
  robot.run(100);
  EXPECT_EQ(robot.last<wire::Event>().number, events[3].number + 7) << "six were lost";
  robot.run(1000);
  EXPECT_GE(robot.last<wire::Counters>().frames_dropped, 6);
}

TEST(Counters, ComeEachSecondAndCountTheLine) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.device().noteOverrun(3);
  for (const uint8_t byte : std::initializer_list<uint8_t>{0, 5, 1, 2, 0}) {
    robot.device().receive(robot.now(), 0, byte);
  }
  robot.run(1100);
  robot.heard().clear();
  robot.run(5000);
  EXPECT_NEAR(static_cast<double>(robot.all<wire::Counters>().size()), 5, 1);
  const wire::Counters counters = robot.last<wire::Counters>();
  EXPECT_EQ(counters.bytes_overrun, 3);
  EXPECT_EQ(counters.frames_bad, 1);
  EXPECT_EQ(counters.frames_received, 8U) << "six settings, APPLY and ORDER";
  EXPECT_EQ(counters.stack_left, 40);
  EXPECT_EQ(counters.battery_mv, 0);
  uint32_t draws = 0;
  for (const wire::Step& step : robot.all<wire::Step>()) {
    if (step.t_ms <= counters.t_ms) draws = step.draw_count;
  }
  EXPECT_EQ(counters.draw_count, draws);
}

TEST(Line, ThatIsFullLosesTheAnswerOnly) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.run(1500);
  const uint16_t dropped = robot.last<wire::Counters>().frames_dropped;
  robot.board().blockLine();
  robot.send(wire::Ping{});
  robot.run(1500);
  EXPECT_EQ(robot.last<wire::Counters>().frames_dropped, dropped + 1);
  EXPECT_TRUE(robot.all<wire::Pong>().empty());
  EXPECT_FALSE(robot.stands());
}

}  // namespace
}  // namespace lab::firmware::device_reports_test
