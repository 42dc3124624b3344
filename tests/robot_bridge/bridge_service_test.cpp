#include "robot_bridge/bridge_service.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/robot_bridge/bridge_fixture.hpp"

namespace lab::bridge {
namespace {

using testing::Contains;
using testing::HasSubstr;

class BridgeServiceTest : public BridgeFixture {};

TEST_F(BridgeServiceTest, FindsARobotAndReportsIt) {
  addRobot(1);
  start();
  run(3);
  ASSERT_TRUE(last.contains(1));
  EXPECT_FALSE(last.contains(2));
  EXPECT_EQ(last[1].uid, simulatedUid(1));
  EXPECT_EQ(last[1].origin, robot_state_t::SIM);
  EXPECT_EQ(last[1].program.hash, 0);
  EXPECT_EQ(last[1].command_seq, 0);
}

TEST_F(BridgeServiceTest, DrivesAtTheOrderedSpeedAndEchoesTheOrder) {
  WireRobot& robot = addRobot(1);
  start();
  run(2);
  command(drive({1}, 0.1, 0.05), 7);
  runCommanded(2);
  EXPECT_EQ(last[1].command_seq, 7);
  EXPECT_EQ(last[1].command_instance, 1);
  EXPECT_EQ(last[1].program.hash, 0);
  EXPECT_EQ(last[1].program.name, kDrivenByHost);
  EXPECT_NEAR(last[1].wheel_left, 0.1, 1e-9);
  EXPECT_NEAR(last[1].wheel_right, 0.05, 1e-9);
  EXPECT_EQ(robot.left(), 94);
  EXPECT_EQ(robot.right(), 47);
}

TEST_F(BridgeServiceTest, RunsTheTableThatTheLightSelects) {
  WireRobot& robot = addRobot(1);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  start();
  command(table({1}), 1);
  runCommanded(4);
  EXPECT_EQ(last[1].program.name, "abp");
  EXPECT_EQ(last[1].program.hash, table({1}).bands[0].program.id.hash);
  EXPECT_EQ(last[1].band, 0);
  EXPECT_NEAR(last[1].light_front, 200 / 1023.0, 1e-6);
  const std::int32_t epoch = last[1].program_epoch;
  const std::int64_t switched = loop.now();
  robot.sensors().light_front = robot.sensors().light_back = 800;
  runCommanded(1);
  EXPECT_EQ(last[1].program.name, "rtp");
  EXPECT_EQ(last[1].program.hash, table({1}).bands[1].program.id.hash);
  EXPECT_EQ(last[1].band, 1);
  EXPECT_EQ(last[1].program_epoch, epoch + 1);
  EXPECT_NEAR(static_cast<double>(last[1].program_start_utime - switched), 10'000, 15'000);
}

TEST_F(BridgeServiceTest, StopsAtOnceAndStaysStopped) {
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(3);
  ASSERT_GT(robot.left(), 0);
  stop(5, false);
  run(0.02);
  EXPECT_EQ(robot.left(), 0);
  runCommanded(1);
  EXPECT_EQ(robot.left(), 0);
  EXPECT_EQ(last[1].stop_seq, 5);
  EXPECT_TRUE(last[1].flags & robot_state_t::FLAG_STOPPED);
  stop(6, true);
  runCommanded(1);
  EXPECT_GT(robot.left(), 0);
  EXPECT_EQ(last[1].stop_seq, 6);
}

TEST_F(BridgeServiceTest, ARobotStandsWhenCommandsStop) {
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(3);
  ASSERT_GT(robot.left(), 0);
  run(0.79);  // the last command came 0.2 s ago and lasts for 1 s
  EXPECT_GT(robot.left(), 0);
  run(0.03);
  EXPECT_EQ(robot.left(), 0);
  run(1);
  EXPECT_TRUE(last[1].flags & robot_state_t::FLAG_LEASE_EXPIRED);
}

TEST_F(BridgeServiceTest, ARobotThatRestartsStandsUntilANewOrder) {
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(3);
  ASSERT_GT(robot.left(), 0);
  robot.boot(wire::kResetWatchdog);
  runCommanded(3);
  EXPECT_EQ(robot.left(), 0);
  EXPECT_EQ(last[1].command_seq, 0);
  EXPECT_THAT(errors, Contains(HasSubstr("robot 1: restarted; it stands")));
  command(drive({1}, 0.1, 0.1), 2);
  runCommanded(1);
  EXPECT_GT(robot.left(), 0);
  EXPECT_EQ(last[1].command_seq, 2);
}

// This happens with a simulated robot if its simulator is restarted.
TEST_F(BridgeServiceTest, ARobotThatRestartsWithTheSameBootNumberStandsToo) {
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(6);
  ASSERT_NE(robot.left(), 0);
  robot.unplug();
  robot.begin();
  run(0.5);
  robot.plug("robot_1");
  const std::int64_t restarted = loop.now() - 500'000;
  runCommanded(4);
  EXPECT_EQ(robot.left(), 0) << "it moves without a new order";
  EXPECT_THAT(errors, testing::Contains(HasSubstr("robot 1: restarted")));
  EXPECT_NEAR(static_cast<double>(last.at(1).utime - loop.now()), 0, 100'000);
  EXPECT_GE(last.at(1).program_start_utime, restarted - 10'000);
  command(drive({1}, 0.1, 0.1), 2);
  runCommanded(2);
  EXPECT_NE(robot.left(), 0);
}

TEST_F(BridgeServiceTest, ReportsEveryDraw) {
  WireRobot& robot = addRobot(1);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  start();
  command(table({1}), 1);
  runCommanded(30);
  ASSERT_GE(steps.size(), 50U);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].draw_count, static_cast<std::int32_t>(i) + 1);
    if (steps[i].slot < 0) continue;  // standing, before it had settings
    EXPECT_EQ(steps[i].phase, 0);
    EXPECT_EQ(steps[i].duration, 0.5);
  }
  EXPECT_EQ(static_cast<std::uint32_t>(steps.back().rng), robot.device().core().rng().digest());
}

TEST_F(BridgeServiceTest, ReportsHostTimesOfARobotWhoseClockRunsWrong) {
  WireRobotOptions options;
  options.clock_rate = 1.005;
  options.clock_start_ms = 0xFFFFF000;  // wraps around after 4 s
  WireRobot& robot = addRobot(1, options);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  start();
  command(table({1}), 1);
  runCommanded(20);
  ASSERT_GE(steps.size(), 20U);
  const robot_step_t step = steps.back();
  const std::uint32_t t_ms = robot.device().core().holdStartMs();
  EXPECT_NEAR(static_cast<double>(step.utime - robot.utimeOf(t_ms)), 0, 3000);
}

TEST_F(BridgeServiceTest, AnOrderBeyondTheWheelLimitIsRejectedAndOthersContinue) {
  WireRobot& first = addRobot(1);
  WireRobot& second = addRobot(2);
  start();
  command(drive({1, 2}, 0.1, 0.1), 1);
  runCommanded(3);
  commanded.seq = 2;
  commanded.orders = {drive({1}, 0.5, 0.5), drive({2}, 0.05, 0.05)};
  commanded.num_orders = 2;
  runCommanded(2);
  EXPECT_TRUE(last[1].flags & robot_state_t::FLAG_REJECTED);
  EXPECT_EQ(last[1].command_seq, 2);
  EXPECT_EQ(first.left(), 94) << "the previous order stays in force";
  EXPECT_FALSE(last[2].flags & robot_state_t::FLAG_REJECTED);
  EXPECT_EQ(last[2].command_seq, 2);
  EXPECT_EQ(second.left(), 47);
  EXPECT_THAT(errors, Contains(HasSubstr("robot 1: wheel speeds beyond the wheels' limit")));
  command(drive({1, 2}, 0.02, 0.02), 3);
  runCommanded(1);
  EXPECT_FALSE(last[1].flags & robot_state_t::FLAG_REJECTED);
  EXPECT_EQ(first.left(), 19);
}

TEST_F(BridgeServiceTest, OfAnOrderForManyARobotKeepsItsOwnPart) {
  addRobot(1);
  start();
  run(2);
  robot_order_t order = drive({1}, 0.5, 0.5);
  order.robot_ids.resize(10'000, 77);
  order.num_robots = 10'000;
  command(order, 1);
  runCommanded(1);
  EXPECT_TRUE(last[1].flags & robot_state_t::FLAG_REJECTED);
  EXPECT_THAT(errors, Contains(HasSubstr("ROBOT_COMMAND 1: robot 1: wheel speeds beyond")));
}

TEST_F(BridgeServiceTest, ARobotResumesAfterARestartIfTheExperimentAllowsIt) {
  experiment.hardware.resume_after_reboot = true;
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(3);
  robot.boot(wire::kResetWatchdog);
  EXPECT_EQ(robot.left(), 0);
  runCommanded(2);
  EXPECT_GT(robot.left(), 0);
  EXPECT_EQ(last[1].command_seq, 1);
}

TEST_F(BridgeServiceTest, DetectsARestartWhoseHelloWasLost) {
  WireRobot& robot = addRobot(1);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(3);
  robot.boot(wire::kResetBrownOut);
  robot.loseOutput();  // loses HELLO, which is not repeated after the next frame from the host
  runCommanded(3);
  EXPECT_EQ(robot.left(), 0);
  EXPECT_THAT(errors, Contains(HasSubstr("robot 1: restarted; it stands")));
}

TEST_F(BridgeServiceTest, AStopAlsoHoldsRobotsThatRestartOrConnectLater) {
  WireRobot& first = addRobot(1);
  start();
  command(drive({1, 2}, 0.1, 0.1), 1);
  runCommanded(3);
  stop(5, false);
  runCommanded(1);
  first.boot(wire::kResetPin);
  WireRobot& second = addRobot(2);
  runCommanded(2);
  command(drive({1, 2}, 0.1, 0.1), 2);
  runCommanded(4);
  for (const std::int32_t id : {1, 2}) {
    EXPECT_TRUE(last[id].flags & robot_state_t::FLAG_STOPPED) << id;
    EXPECT_EQ(last[id].stop_seq, 5) << id;
    EXPECT_EQ(last[id].command_seq, 2) << id;
  }
  EXPECT_EQ(first.left(), 0);
  EXPECT_EQ(second.left(), 0);
}

TEST_F(BridgeServiceTest, AStopArrivesOnANoisyLine) {
  WireRobotOptions options;
  options.bit_error_rate = 2e-3;  // one frame in two is damaged
  WireRobot& robot = addRobot(1, options);
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(10);
  for (std::int64_t seq = 1; seq <= 20; ++seq) {
    stop(2 * seq, false);
    runCommanded(2);
    EXPECT_TRUE(robot.report().flags & dynamics::kStopped);
    EXPECT_EQ(robot.left(), 0);
    stop(2 * seq + 1, true);
    runCommanded(2);
    EXPECT_FALSE(robot.report().flags & dynamics::kStopped);
  }
}

TEST_F(BridgeServiceTest, WorksWithARobotThatAnswersSlowly) {
  WireRobotOptions options;
  options.delay_us = 700'000;  // longer than the timeout of a command
  WireRobot& robot = addRobot(1, options);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  start();
  command(table({1}), 1);
  runCommanded(30);
  EXPECT_EQ(last[1].command_seq, 1);
  EXPECT_EQ(last[1].program.name, "abp");
  EXPECT_EQ(last[1].program.hash, table({1}).bands[0].program.id.hash);
}

TEST_F(BridgeServiceTest, SeedsAreDerivedFromTheExperimentAndNeverRepeat) {
  WireRobot& robot = addRobot(1);
  start();
  run(3);
  const auto digestOf = [this](const char* purpose) {
    dynamics::Rng rng;
    rng.seed(deriveSeed(experiment.seed, 1, purpose));
    return rng.digest();
  };
  EXPECT_EQ(robot.device().core().rng().digest(), digestOf("program"));
  robot.boot(wire::kResetPin);
  run(3);
  EXPECT_EQ(robot.device().core().rng().digest(), digestOf("program restart 1"));
  robot.boot(wire::kResetPin);
  run(3);
  EXPECT_EQ(robot.device().core().rng().digest(), digestOf("program restart 2"));
}

TEST_F(BridgeServiceTest, LoadsTheProgramsOnceAndReportsHowLongItTook) {
  WireRobot& robot = addRobot(1);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  std::string line;
  other.subscribe<service_status_t>(channels::kServiceStatus, [&](const service_status_t& status) {
    for (const stream_count_t& row : status.received) {
      if (row.channel == "serial line" && row.sender.starts_with("robot 1 ")) line = row.sender;
    }
  });
  start();
  command(table({1}), 1);
  runCommanded(4);
  EXPECT_THAT(line, testing::HasSubstr(", 2 programs loaded in "));
  EXPECT_EQ(last[1].program.name, "abp");
  // They survive a restart of the robot.
  robot.boot(wire::kResetPower);
  runCommanded(2);
  command(table({1}), 2);
  runCommanded(4);
  EXPECT_EQ(last[1].program.name, "abp");
  EXPECT_THAT(line, testing::HasSubstr(", 2 programs loaded in "));
}

TEST_F(BridgeServiceTest, FourProgramsReplaceFourOthersThoughARobotHasFivePlaces) {
  WireRobot& robot = addRobot(1);
  robot.sensors().light_front = robot.sensors().light_back = 900;
  start();
  const auto four = [](const char* speed) {
    robot_order_t order = table({1});
    order.bands.clear();
    for (int band = 0; band < 4; ++band) {
      light_band_t next{};
      next.low = band / 4.0;
      next.high = (band + 1) / 4.0;
      next.program = toMessage(
          shippedProgram("abp", {{"v", speed}, {"epsilon", std::to_string(band + 1) + " s"}}));
      order.bands.push_back(next);
    }
    order.num_bands = 4;
    return order;
  };
  std::int64_t seq = 0;
  for (const char* speed : {"3 cm/s", "4 cm/s", "5 cm/s"}) {
    const robot_order_t order = four(speed);
    command(order, ++seq);
    runCommanded(8);
    EXPECT_EQ(last[1].command_seq, seq);
    EXPECT_EQ(last[1].program.hash, order.bands[3].program.id.hash) << speed;
    EXPECT_FALSE(last[1].flags & robot_state_t::FLAG_REJECTED);
  }
}

TEST_F(BridgeServiceTest, ARobotRunsItsOldProgramUntilTheNewOneIsLoaded) {
  WireRobotOptions options;
  options.delay_us = 60'000;  // loading takes more than the lease
  WireRobot& robot = addRobot(1, options);
  robot.sensors().light_front = robot.sensors().light_back = 200;
  start();
  command(table({1}), 1);
  runCommanded(8);
  ASSERT_EQ(last[1].command_seq, 1);
  const std::uint32_t epoch = robot.report().program_epoch;
  robot_order_t next = table({1});
  next.bands[0].program = toMessage(shippedProgram("run_reverse"));
  next.bands[1].program = toMessage(shippedProgram("levy"));
  commanded.orders = {next};
  command(next, 2);
  commanded.lease_ms = 500;
  bool lease_over = false;
  for (int i = 0; i < 40 && last[1].command_seq != 2; ++i) {
    runCommanded(0.2);
    commanded.lease_ms = 500;
    lease_over = lease_over || (robot.report().flags & dynamics::kLeaseExpired) != 0;
  }
  EXPECT_EQ(last[1].command_seq, 2);
  runCommanded(0.4);
  EXPECT_EQ(last[1].program.name, "run_reverse");
  EXPECT_FALSE(lease_over);
  EXPECT_EQ(robot.report().program_epoch, epoch + 1) << "it changed once, and never stood";
}

TEST_F(BridgeServiceTest, SensesReachTheProgramAndTheirTimesTheStatus) {
  addRobot(1).sensors().light_front = 200;
  start();
  command(table({1}), 1);
  runCommanded(3);
  EXPECT_EQ(last[1].senses_utime, 0);
  robot_senses_t senses{};
  senses.robots.resize(1);
  senses.robots[0].robot_id = 1;
  senses.robots[0].values[5] = 2.5F;
  senses.num_robots = 1;
  senses.utime = loop.now() - 40'000;
  const std::int64_t sent = loop.now();
  other.publish(channels::kRobotSenses, senses);
  bus.deliver();
  runCommanded(0.4);
  EXPECT_GT(last[1].senses_utime, 0);
  EXPECT_NEAR(static_cast<double>(last[1].senses_since_utime - sent), 10'900, 1'000);
}

TEST_F(BridgeServiceTest, SendsTheSameSettingsAsASimulatedRobotGets) {
  WireRobot& robot = addRobot(1);
  start();
  command(table({1}), 1);
  runCommanded(3);
  OrderSettings requested =
      settingsFrom(table({1}), {experiment.hardware.max_wheel_speed, experiment.hardware.diameter},
                   experiment.hardware.sensor_period);
  requested.core.robot_id = 1;
  EXPECT_TRUE(robot.device().core().settings() == requested.core);
}

TEST_F(BridgeServiceTest, ASilentRobotIsOmittedAndReported) {
  WireRobot& first = addRobot(1);
  addRobot(2);
  start();
  run(3);
  ASSERT_EQ(statuses.back().robots.size(), 2U);
  first.switchOff();
  run(2.5);
  EXPECT_EQ(statuses.back().robots.size(), 1U);
  EXPECT_THAT(errors, Contains(HasSubstr("robot_1: robot 1 is silent")));
  const std::size_t before = statuses.size();
  robots[1].switchOff();
  run(3);
  EXPECT_LT(statuses.size() - before, 60U) << "nothing is published without new data";
}

class ManyRobots : public BridgeFixture {
 protected:
  ManyRobots() : BridgeFixture(60) {}
};

TEST_F(ManyRobots, ReportsAllRobotsThatBecomeSilentAtOnce) {
  for (int id = 1; id <= 60; ++id) addRobot(id);
  start();
  run(5);
  for (WireRobot& robot : robots) robot.switchOff();
  run(30);

  for (int id = 1; id <= 60; ++id) {
    const std::string number = std::to_string(id);
    const std::string name = "robot_" + number + ": robot " + number + " is silent";
    EXPECT_THAT(errors, Contains(HasSubstr(name)));
  }
}

TEST_F(BridgeServiceTest, ReportsTheLossesOfTheLines) {
  WireRobotOptions options;
  options.bit_error_rate = 1e-3;
  addRobot(1, options);
  stream_count_t row{};
  other.subscribe<service_status_t>(channels::kServiceStatus, [&](const service_status_t& status) {
    for (const stream_count_t& stream : status.received) {
      if (stream.channel == "serial line" && stream.sender.starts_with("robot 1 ")) row = stream;
    }
  });
  start();
  command(drive({1}, 0.1, 0.1), 1);
  runCommanded(20);
  EXPECT_GT(row.received, 400);
  EXPECT_GT(row.lost, 20);
  EXPECT_GT(row.decode_errors, 20);
}

TEST_F(BridgeServiceTest, StoresACalibrationAndReportsTheStoredValues) {
  WireRobot& robot = addRobot(1);
  std::optional<robot_calibration_t> held;
  other.subscribe<robot_calibration_t>(
      channels::kCalibrationStatus, [&held](const robot_calibration_t& status) { held = status; });
  start();
  run(3);
  robot_calibration_t request{};
  request.seq = 9;
  motor_calibration_t requested{};
  requested.robot_id = 1;
  requested.gain_left = 0.93;
  requested.gain_right = 1.07;
  requested.dead_band_left = 20.0 / 255;
  requested.dead_band_right = 25.0 / 255;
  requested.wheel_base = 0.0781;
  request.robots = {requested};
  request.num_robots = 1;
  for (int i = 0; i < 6; ++i) {
    other.publishCommand(channels::kRobotCalibration, request);
    run(0.5);
  }
  ASSERT_TRUE(held);
  EXPECT_EQ(held->seq, 9);
  ASSERT_EQ(held->robots.size(), 1U);
  EXPECT_DOUBLE_EQ(held->robots[0].gain_left, 0.93);
  EXPECT_DOUBLE_EQ(held->robots[0].dead_band_right, 25.0 / 255);
  EXPECT_DOUBLE_EQ(held->robots[0].wheel_base, 0.0781);
  robot.boot(wire::kResetPower);  // the calibration must survive this
  EXPECT_EQ(robot.device().settings().left.gain_ppm, 930'000);
  EXPECT_EQ(robot.device().settings().right.dead_band, 25);

  // From now on turning rates are converted with the robot's own wheel base.
  run(3);
  command(table({1}), 1);
  runCommanded(3);
  OrderSettings with_own = settingsFrom(table({1}), {experiment.hardware.max_wheel_speed, 0.0781},
                                        experiment.hardware.sensor_period);
  with_own.core.robot_id = 1;
  EXPECT_TRUE(robot.device().core().settings() == with_own.core);
}

TEST_F(BridgeServiceTest, ReadsACalibrationWithoutStoringOne) {
  WireRobot& robot = addRobot(1);
  std::optional<robot_calibration_t> held;
  other.subscribe<robot_calibration_t>(
      channels::kCalibrationStatus, [&held](const robot_calibration_t& status) { held = status; });
  start();
  run(3);
  robot_calibration_t question{};
  question.seq = 4;
  question.robots.resize(1);
  question.robots[0].robot_id = 1;
  question.num_robots = 1;
  for (int i = 0; i < 4; ++i) {
    other.publishCommand(channels::kRobotCalibration, question);
    run(0.5);
  }
  ASSERT_TRUE(held);
  EXPECT_EQ(held->seq, 4);
  ASSERT_EQ(held->robots.size(), 1U);
  EXPECT_EQ(held->robots[0].gain_left, 1);
  EXPECT_EQ(held->robots[0].dead_band_left, 0);
  EXPECT_EQ(robot.device().settings().left.gain_ppm, 1'000'000);
}

TEST_F(BridgeServiceTest, AnInvalidCalibrationIsReportedAndChangesNothing) {
  WireRobot& robot = addRobot(1);
  start();
  run(3);
  robot_calibration_t request{};
  request.seq = 9;
  motor_calibration_t requested{};
  requested.robot_id = 1;
  requested.gain_left = 9;
  request.robots = {requested};
  request.num_robots = 1;
  for (int i = 0; i < 4; ++i) {
    other.publishCommand(channels::kRobotCalibration, request);
    run(0.5);
  }
  EXPECT_THAT(errors, Contains(HasSubstr("robot 1: did not accept its calibration")));
  EXPECT_EQ(robot.device().settings().left.gain_ppm, 1'000'000);
}

TEST_F(BridgeServiceTest, RepeatedRunsAreIdenticalToTheBit) {
  const auto record = [] {
    class Again : public BridgeServiceTest {
     public:
      void TestBody() override {}
      std::vector<std::string> make() {
        WireRobotOptions options;
        options.bit_error_rate = 5e-4;
        addRobot(1, options).sensors().light_front = 300;
        addRobot(2).sensors().light_front = 300;
        std::vector<std::string> packets;
        bus.subscribeAll([&packets](const Packet& packet) {
          packets.emplace_back(packet.data.begin(), packet.data.end());
        });
        start();
        command(table({1, 2}), 1);
        runCommanded(10);
        return packets;
      }
    };
    return Again().make();
  };
  EXPECT_EQ(record(), record());
}

}  // namespace
}  // namespace lab::bridge
