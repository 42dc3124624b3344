// A chip with a faulty line: effects on frames in both directions.
#include "sim_svc/emulator/emulated_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

class Line {
 public:
  explicit Line(RobotSettings settings) : robot_(shippedProgram(), prepare(settings), kStart) {}

  void run(double seconds) {
    const auto until = robot_.now() + static_cast<std::int64_t>(seconds * 1e6);
    while (robot_.now() < until) {
      robot_.advance(robot_.now() + 2000);
      for (const std::uint8_t byte : robot_.takeSent()) {
        ++bytes;
        if (decoder_.push(byte)) frames.push_back(decoder_.frame());
      }
    }
  }

  template <class Message>
  void send(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    std::uint8_t encoded[wire::kMaxFrame];
    const std::uint8_t size = wire::encode(frame, encoded);
    robot_.receive(std::span<const std::uint8_t>(encoded, size));
  }

  template <class Message>
  int count() const {
    Message message;
    return static_cast<int>(
        std::count_if(frames.begin(), frames.end(),
                      [&](const wire::Frame& frame) { return wire::unpack(frame, message); }));
  }
  int bad() const {
    const auto& counts = decoder_.counts();
    return counts.crc + counts.malformed + counts.version;
  }

  std::vector<wire::Frame> frames;
  int bytes = 0;

 private:
  static RobotSettings prepare(RobotSettings settings) {
    settings.eeprom = storeWithUid(kTestUid);
    settings.boot_us = kStart;
    return settings;
  }

  EmulatedRobot robot_;
  wire::Decoder decoder_;
  std::uint8_t seq_ = 0;
};

int pongsOf(Line& line, int pings) {
  for (int i = 0; i < pings; ++i) {
    line.send(wire::Ping{});
    line.run(0.1);
  }
  return line.count<wire::Pong>();
}

TEST(EmulatedRobot, AnOscillatorErrorOfThreePercentCausesNoErrors) {
  for (const double rate : {0.97, 1.0, 1.03}) {
    RobotSettings settings;
    settings.clock_rate = rate;
    Line line(settings);
    line.run(0.1);
    EXPECT_EQ(pongsOf(line, 20), 20) << rate;
    EXPECT_EQ(line.bad(), 0) << rate;
  }
}

TEST(EmulatedRobot, AHostAtAnotherSpeedSendsAndReceivesGarbage) {
  for (const int baud : {9600, 57600, 115200}) {
    RobotSettings settings;
    settings.line_baud = baud;
    Line line(settings);
    line.run(2.5);
    EXPECT_EQ(pongsOf(line, 20), 0) << baud;
    EXPECT_TRUE(line.frames.empty()) << baud;
    EXPECT_GT(line.bytes, 50) << baud;
  }
}

TEST(EmulatedRobot, NothingPassesWhileTheCableIsUnplugged) {
  RobotSettings settings;
  settings.line.outages = {{kStart + 2'000'000, kStart + 4'000'000}};
  Line line(settings);
  line.run(1);
  line.send(wire::Ping{});
  line.run(1.1);
  const int before = line.bytes;
  EXPECT_GT(before, 0);
  EXPECT_EQ(pongsOf(line, 10), 1);  // from before
  EXPECT_EQ(line.bytes, before);
  line.run(1);
  EXPECT_EQ(pongsOf(line, 10), 11);
}

TEST(EmulatedRobot, WrongBitsLoseOnlyTheirOwnFrames) {
  RobotSettings settings;
  settings.line.bit_error_rate = 1e-3;
  Line line(settings);
  line.run(0.1);
  const int pongs = pongsOf(line, 300);
  // 17 bytes to the robot and 23 back, ten bits each: two of three exchanges succeed.
  EXPECT_GT(pongs, 160);
  EXPECT_LT(pongs, 240);
  EXPECT_GT(line.bad(), 50);
}

}  // namespace
}  // namespace lab::emulator
