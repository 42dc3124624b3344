#include <gmock/gmock.h>

#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware {
namespace {

using testing::Contains;
using testing::Not;

wire::Stop stop(uint8_t id, uint8_t action = wire::Stop::kStop) {
  wire::Stop stop;
  stop.id = id;
  stop.action = action;
  return stop;
}

TEST(Lease, EndsAtTheExactMillisecond) {
  for (uint32_t lease_ms : {1U, 20U, 333U, 1000U}) {
    RobotOnBench robot;
    startPrograms(robot, 5000);
    robot.send(robot.order(wire::Order::kTable, lease_ms));
    robot.run(lease_ms - 1);
    EXPECT_FALSE(robot.stands()) << lease_ms;
    robot.run(1);
    EXPECT_TRUE(robot.stands()) << lease_ms;
    robot.run(300);
    EXPECT_EQ(robot.last<wire::Event>().code, wire::kLeaseOver);
    EXPECT_EQ(robot.last<wire::Event>().t_ms, robot.now() - 300);
    EXPECT_TRUE(robot.last<wire::Telemetry>().flags & dynamics::kLeaseExpired);
  }
}

TEST(Lease, IsRenewedOnlyByOrders) {
  RobotOnBench robot;
  startPrograms(robot, 500);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, 500)).status, wire::kOk);
    robot.run(300);
    EXPECT_FALSE(robot.stands());
  }
  for (int i = 0; i < 10; ++i) {
    robot.send(wire::Ping{});
    robot.run(60);
  }
  EXPECT_TRUE(robot.stands());
  robot.command(robot.order(wire::Order::kTable, 500));
  EXPECT_FALSE(robot.stands());
}

TEST(Lease, EndedByTheHostIsNotReportedAsSilence) {
  RobotOnBench robot;
  startPrograms(robot, 5000);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, 0)).status, wire::kOk);
  EXPECT_TRUE(robot.stands());
  EXPECT_THAT(robot.eventCodes(), Not(Contains(wire::kLeaseOver)));
}

TEST(Lease, IsLimitedToTheLongest) {
  RobotOnBench robot;
  startPrograms(robot, 0xFFFFFFFFU);
  EXPECT_FALSE(robot.stands());
  robot.run(1000);
  EXPECT_FALSE(robot.stands());
}

TEST(Stop, LatchesAtOnceInEveryState) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.send(stop(7));
  EXPECT_TRUE(robot.stands()) << "immediately, without a tick";
  for (uint8_t mode : {wire::Order::kTable, wire::Order::kDrive, wire::Order::kStand}) {
    EXPECT_EQ(robot.command(robot.order(mode, 60000)).status, wire::kOk);
    EXPECT_TRUE(robot.stands());
  }
  dynamics::CoreSettings other = twoPrograms();
  other.programs[0] = hashOf(wheelsText(100000, 0));
  EXPECT_EQ(robot.configure(other).status, wire::kOk);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, 60000)).status, wire::kOk);
  robot.sensors().light_front = robot.sensors().light_back = 900;
  robot.run(2000);
  EXPECT_TRUE(robot.stands());
  EXPECT_EQ(robot.last<wire::Telemetry>().stop_id, 7);
  EXPECT_TRUE(robot.last<wire::Telemetry>().flags & dynamics::kStopped);

  EXPECT_EQ(robot.command(stop(8, wire::Stop::kRelease)).status, wire::kOk);
  EXPECT_FALSE(robot.stands());
  robot.run(100);
  EXPECT_EQ(robot.last<wire::Telemetry>().stop_id, 8);
}

TEST(Stop, WorksOnARobotThatWasNeverConfigured) {
  RobotOnBench robot;
  robot.boot();
  EXPECT_EQ(robot.command(stop(1)).status, wire::kOk);
  EXPECT_EQ(robot.configure(twoPrograms()).status, wire::kOk);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, 60000)).status, wire::kOk);
  robot.run(500);
  EXPECT_TRUE(robot.stands());
}

TEST(Stop, ReportsEachChangeOnce) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.run(200);
  robot.heard().clear();
  for (uint8_t id = 1; id <= 3; ++id) robot.command(stop(id));
  for (uint8_t id = 4; id <= 5; ++id) robot.command(stop(id, wire::Stop::kRelease));
  const std::vector<wire::Event> events = robot.all<wire::Event>();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].code, wire::kStopLatched);
  EXPECT_EQ(events[0].data, 1U);
  EXPECT_EQ(events[1].code, wire::kStopReleased);
  EXPECT_EQ(events[1].data, 4U);
}

TEST(Stop, WithAnUnknownActionDoesNothing) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  const wire::Ack ack = robot.command(stop(9, 0));
  EXPECT_EQ(ack.status, wire::kBadValue);
  EXPECT_EQ(ack.detail, 1);
  EXPECT_FALSE(robot.stands());
  EXPECT_NE(robot.last<wire::Telemetry>().stop_id, 9);
}

TEST(Stop, IsExecutedAgainWhenItIsRepeated) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  const uint8_t seq = robot.send(stop(1));
  robot.run(60);
  robot.heard().clear();
  robot.sendAgain(stop(1), seq);
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Ack>().status, wire::kOk);
  // A restarted host counts from the beginning: the same seq may have the opposite action.
  robot.sendAgain(stop(1, wire::Stop::kRelease), seq);
  EXPECT_FALSE(robot.stands());
  robot.sendAgain(stop(1), seq);
  EXPECT_TRUE(robot.stands());
}

// The answer to STOP waits for at most one other frame, whatever else is due.
TEST(Stop, IsAnsweredBeforeWaitingReports) {
  RobotOnBench robot;
  dynamics::CoreSettings busy = twoPrograms();
  busy.programs[0] =
      hashOf(abpText("6 cm/s", "3 ms", "3 rad/s"));  // more draws than the line can carry
  robot.boot();
  robot.configure(busy);
  wire::SetParam fast;
  fast.id = wire::kTelemetryPeriod;
  fast.value = 10;
  EXPECT_EQ(robot.command(fast).status, wire::kOk);
  robot.command(robot.order(wire::Order::kTable, 60000));
  for (uint32_t phase = 0; phase < 100; ++phase) {
    robot.run(37);
    robot.heard().clear();
    const uint8_t seq = robot.send(stop(1));
    EXPECT_TRUE(robot.stands());
    robot.run(15);  // 41 bytes in transmission and 12 bytes of the answer take 13.8 ms
    std::size_t before = 0;
    bool answered = false;
    for (const Heard& heard : robot.heard()) {
      wire::Ack ack;
      if (heard.frame.seq == seq && wire::unpack(heard.frame, ack)) {
        answered = true;
        break;
      }
      ++before;
    }
    EXPECT_TRUE(answered) << phase;
    EXPECT_LE(before, 1U) << phase;
    robot.send(stop(1, wire::Stop::kRelease));
  }
}

}  // namespace
}  // namespace lab::firmware
