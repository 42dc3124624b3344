#include <gmock/gmock.h>

#include <set>
#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware {
namespace {

using testing::ElementsAre;

Settings withUid(uint32_t uid) {
  Settings settings;
  settings.uid = uid;
  return settings;
}

TEST(Boot, SendsHelloWithMotorsOff) {
  RobotOnBench robot(withUid(0x51000007));
  robot.boot(wire::kResetBrownOut);
  EXPECT_TRUE(robot.stands());
  EXPECT_EQ(robot.board().motor_changes, 1) << "motors are switched off explicitly";
  robot.run(20);
  const wire::Hello hello = robot.last<wire::Hello>();
  EXPECT_EQ(hello.schema, wire::kSchema);
  EXPECT_EQ(hello.firmware, kFirmwareVersion);
  EXPECT_EQ(hello.build, 0x1234ABCDU);
  EXPECT_EQ(hello.uid, 0x51000007U);
  EXPECT_EQ(hello.reset_cause, wire::kResetBrownOut);
  EXPECT_EQ(hello.board, 2);
  EXPECT_EQ(hello.settings_from, 0);
  EXPECT_EQ(hello.uptime_ms, 0U);
  EXPECT_EQ(hello.baud, 38400U);
}

TEST(Boot, SendsOnlyHelloEverySecondUntilAHostSendsAFrame) {
  RobotOnBench robot;
  robot.boot();
  robot.run(5500);
  const std::vector<wire::Hello> hellos = robot.all<wire::Hello>();
  ASSERT_EQ(hellos.size(), 6U);
  for (uint32_t i = 0; i < 6; ++i) EXPECT_EQ(hellos[i].uptime_ms, 1000 * i);
  EXPECT_EQ(robot.heard().size(), 6U);

  robot.send(wire::Ping{});
  robot.run(3000);
  EXPECT_EQ(robot.all<wire::Hello>().size(), 6U);
  EXPECT_GT(robot.all<wire::Telemetry>().size(), 50U);
}

TEST(Boot, GarbageAndForeignFramesDoNotCountAsAHost) {
  RobotOnBench robot;
  robot.boot();
  for (int i = 0; i < 3000; ++i) {
    robot.device().receive(robot.now(), 0, static_cast<uint8_t>(i * 37 % 251));
  }
  robot.sendAgain(wire::Telemetry{}, 5);  // an echo of a robot
  robot.run(1500);
  EXPECT_EQ(robot.all<wire::Hello>().size(), 2U);
  EXPECT_EQ(robot.heard().size(), 2U);
}

TEST(Boot, SendsItsEventsToTheFirstHost) {
  RobotOnBench robot;
  robot.boot(wire::kResetWatchdog);
  robot.device().noteWatchdog(robot.now());
  robot.run(2000);
  robot.send(wire::Ping{});
  robot.run(200);
  EXPECT_THAT(robot.eventCodes(),
              ElementsAre(wire::kBooted, wire::kSettingsDefault, wire::kWatchdogRestart));
  EXPECT_EQ(robot.all<wire::Event>()[0].data, uint32_t{wire::kResetWatchdog});
  EXPECT_EQ(robot.all<wire::Event>()[2].number, 3);
  EXPECT_EQ(robot.all<wire::Event>()[2].t_ms, 0U);
}

TEST(Boot, ValidSettingsGiveNoEvent) {
  RobotOnBench robot(withUid(1));
  robot.boot();
  robot.send(wire::Ping{});
  robot.run(200);
  EXPECT_THAT(robot.eventCodes(), ElementsAre(wire::kBooted));
}

TEST(Boot, EveryBootHasADifferentId) {
  RobotOnBench robot(withUid(0x51000007));
  std::set<uint16_t> ids;
  for (int i = 0; i < 65536; ++i) {
    robot.boot();
    robot.run(10);
    ids.insert(robot.last<wire::Hello>().boot_id);
    robot.heard().clear();
  }
  EXPECT_EQ(ids.size(), 65536U);
}

TEST(Boot, IdsDifferEvenIfThePowerFailsWhileTheyAreCounted) {
  // At every carry, the low byte is written and the high byte is not.
  for (int high = 0; high < 256; ++high) {
    RobotOnBench robot(withUid(3));
    robot.board().store[kBootCounterAddress] = 0xFE;
    robot.board().store[kBootCounterAddress + 1] = static_cast<uint8_t>(high);
    robot.boot();
    robot.run(20);
    const uint16_t before = robot.last<wire::Hello>().boot_id;
    robot.boot();
    robot.board().store[kBootCounterAddress + 1] = static_cast<uint8_t>(high);
    robot.boot();
    robot.heard().clear();
    robot.run(60);
    EXPECT_NE(robot.last<wire::Hello>().boot_id, before);
  }
}

TEST(Boot, DrawsDifferBetweenBootsAndBetweenRobots) {
  const auto digest = [](uint32_t uid, int boots) {
    RobotOnBench robot(withUid(uid));
    for (int i = 0; i < boots; ++i) robot.boot();
    return robot.device().core().rng().digest();
  };
  EXPECT_NE(digest(1, 1), digest(1, 2));
  EXPECT_NE(digest(1, 1), digest(2, 1));
  EXPECT_EQ(digest(1, 1), digest(1, 1));
}

TEST(Boot, NeverMovesBeforeSettingsAndLease) {
  RobotOnBench robot;
  robot.boot();
  robot.run(3000);
  // A lease without settings.
  wire::Order order = robot.order(wire::Order::kDrive, 10000);
  EXPECT_EQ(robot.command(order).status, wire::kOk);
  order.mode = wire::Order::kTable;
  EXPECT_EQ(robot.command(order).status, wire::kOk);
  robot.run(1000);
  EXPECT_EQ(robot.board().motor_changes, 1);

  // Settings without a lease.
  RobotOnBench other;
  other.boot();
  EXPECT_EQ(other.configure(twoPrograms()).status, wire::kOk);
  other.run(3000);
  EXPECT_EQ(other.board().motor_changes, 1);
  EXPECT_TRUE(other.stands());
}

TEST(Boot, WorksAcrossTheWrapOfItsClock) {
  RobotOnBench robot(0xFFFFFF00U);
  startPrograms(robot, 2000);
  EXPECT_LT(robot.now(), 0x1000U);
  EXPECT_FALSE(robot.stands());
  robot.heard().clear();
  robot.run(1000);
  EXPECT_NEAR(static_cast<double>(robot.all<wire::Telemetry>().size()), 20, 1);
  robot.run(2000);
  EXPECT_TRUE(robot.stands());
}

}  // namespace
}  // namespace lab::firmware
