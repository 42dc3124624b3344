#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

TEST(ChipProtocol, SendsHelloAtBootWithTheUidFromItsEeprom) {
  RobotOnChip robot;
  robot.chip().switchOn();
  robot.run(50);
  const auto hellos = robot.all<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  const wire::Hello& hello = hellos.front().message;
  EXPECT_EQ(hello.uid, kTestUid);
  EXPECT_EQ(hello.schema, wire::kSchema);
  EXPECT_EQ(hello.reset_cause, wire::kResetPower);
  EXPECT_EQ(hello.board, 1);
  EXPECT_EQ(hello.settings_from, 0);
  EXPECT_EQ(hello.baud, 38400U);
  EXPECT_NEAR(robot.chip().baud(), 38461.5, 0.1);
}

TEST(ChipProtocol, TheBytesOfAFrameHaveNoGaps) {
  RobotOnChip robot;
  robot.chip().switchOn();
  robot.run(50);
  const auto& bytes = robot.bytes();
  ASSERT_EQ(bytes.size(), wire::payloadSize<wire::Hello>() + std::size_t{wire::kFrameOverhead});
  const double took = static_cast<double>(bytes.back().cycle - bytes.front().cycle);
  EXPECT_NEAR(took, 2080.0 * static_cast<double>(bytes.size() - 1), 80);
}

TEST(ChipProtocol, RepeatsHelloEverySecondUntilTheHostSendsAFrame) {
  RobotOnChip robot;
  robot.chip().switchOn();
  robot.run(3500);
  EXPECT_EQ(robot.all<wire::Hello>().size(), 4U);
  EXPECT_EQ(robot.heard().size(), 4U);
  robot.send(wire::Ping{});
  robot.forget();
  robot.run(2000);
  EXPECT_TRUE(robot.all<wire::Hello>().empty());
}

TEST(ChipProtocol, EveryBootHasADifferentId) {
  RobotOnChip robot;
  robot.chip().switchOn();
  robot.run(50);
  robot.chip().switchOff();
  robot.run(50);
  robot.chip().switchOn();
  robot.run(50);
  robot.chip().reset();
  robot.run(50);
  const auto hellos = robot.all<wire::Hello>();
  ASSERT_EQ(hellos.size(), 3U);
  EXPECT_NE(hellos[0].message.boot_id, hellos[1].message.boot_id);
  EXPECT_NE(hellos[1].message.boot_id, hellos[2].message.boot_id);
  EXPECT_EQ(hellos[1].message.reset_cause, wire::kResetPower);
  EXPECT_EQ(hellos[2].message.reset_cause, wire::kResetPin);
}

TEST(ChipProtocol, SendsTelemetryTwentyTimesASecondWithTheSensorReadings) {
  RobotOnChip robot;
  robot.start();
  robot.light(700);
  for (unsigned i = 0; i < 6; ++i) robot.ir(i, static_cast<std::uint16_t>(100 + i));
  robot.run(100);
  robot.forget();
  robot.run(2000);
  const auto telemetry = robot.all<wire::Telemetry>();
  ASSERT_NEAR(static_cast<double>(telemetry.size()), 40, 1);
  for (std::size_t i = 1; i < telemetry.size(); ++i) {
    EXPECT_EQ(telemetry[i].seq, static_cast<std::uint8_t>(telemetry[i - 1].seq + 1));
  }
  const wire::Telemetry& last = telemetry.back().message;
  EXPECT_EQ(last.sensors[0], 700);
  EXPECT_EQ(last.sensors[1], 700);
  for (unsigned i = 0; i < 6; ++i) EXPECT_EQ(last.sensors[2 + i], 100 + i) << i;
}

TEST(ChipProtocol, TransmitsEveryCountOfTheConverter) {
  RobotOnChip robot;
  robot.start();
  EXPECT_EQ(robot.command(wire::SetParam{wire::kTelemetryPeriod, 25}).status, wire::kOk);
  constexpr std::uint16_t kCounts[] = {0, 1, 2, 511, 512, 777, 1021, 1022, 1023};
  for (const std::uint16_t counts : kCounts) {
    robot.light(counts);
    robot.run(75);
    EXPECT_EQ(robot.last<wire::Telemetry>()->sensors[0], counts);
  }
}

TEST(ChipProtocol, PongContainsTheTimeOfThePing) {
  RobotOnChip robot;
  robot.start();
  robot.run(500);
  std::vector<double> offsets;
  for (int i = 0; i < 20; ++i) {
    robot.run(17.3, 17.3);
    robot.forget();
    robot.send(wire::Ping{0x12345678, static_cast<std::uint32_t>(i)});
    const double end_ms = static_cast<double>(robot.chip().receivingUntil()) / kCyclesPerMs;
    robot.run(60);
    const auto pongs = robot.all<wire::Pong>();
    ASSERT_EQ(pongs.size(), 1U);
    EXPECT_EQ(pongs[0].message.token_high, 0x12345678U);
    EXPECT_EQ(pongs[0].message.token_low, static_cast<std::uint32_t>(i));
    offsets.push_back(pongs[0].message.t_ms + pongs[0].message.t_us / 1000.0 - end_ms);
  }
  // The offset is the time until the program started its clock; the rates are equal.
  for (const double offset : offsets) EXPECT_NEAR(offset, offsets.front(), 0.02);
}

TEST(ChipProtocol, RefusesAnUnknownMessageAndExecutesTheNextOne) {
  RobotOnChip robot;
  robot.start();
  wire::Frame frame;
  frame.type = 0x7E;
  frame.seq = 77;
  frame.size = 40;
  robot.sendFrame(frame);
  robot.run(60);
  const auto acks = robot.all<wire::Ack>();
  ASSERT_FALSE(acks.empty());
  EXPECT_EQ(acks.back().seq, 77);
  EXPECT_EQ(acks.back().message.type, 0x7E);
  EXPECT_EQ(acks.back().message.status, wire::kUnknownType);
  EXPECT_EQ(robot.command(wire::SetParam{wire::kStepLog, 1}).status, wire::kOk);
}

TEST(ChipProtocol, AMessageOfTheWrongLengthIsRefused) {
  RobotOnChip robot;
  robot.start();
  wire::Frame frame;
  frame.type = wire::Order::kType;
  frame.seq = 78;
  frame.size = 3;
  robot.sendFrame(frame);
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Ack>()->status, wire::kBadLength);
}

TEST(ChipProtocol, GarbageBetweenFramesLosesNoFrame) {
  RobotOnChip robot;
  robot.start();
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    std::vector<std::uint8_t> garbage(random.next() % 90);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(random.next());
    robot.chip().receive(garbage);
    robot.run(30);
    robot.forget();
    robot.send(wire::Ping{1, static_cast<std::uint32_t>(i)});
    robot.run(60);
    ASSERT_EQ(robot.all<wire::Pong>().size(), 1U) << i;
  }
}

}  // namespace
}  // namespace lab::emulator
