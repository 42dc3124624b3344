// Lines that appear, disappear, send invalid data or are in use by another program.
#include "robot_bridge/lines/port_manager.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <vector>

#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "robot/wire/crc16.hpp"
#include "tests/support/wire_robot.hpp"

namespace lab::bridge {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint32_t kUid = 4711;

class PortManagerTest : public testing::Test {
 protected:
  PortManagerTest() {
    loop.every(20'000, loop.now(), [this] {
      if (keeper_runs) dut.tick();
    });
  }

  static LinkSettings link(std::int32_t id) {
    LinkSettings settings;
    settings.id = id;
    return settings;
  }

  WireRobot& addRobot(const std::string& line, std::uint32_t uid = kUid) {
    WireRobotOptions options;
    options.uid = uid;
    WireRobot& robot = wire_robots.emplace_back(loop, ports, options);
    robot.plug(line);
    return robot;
  }

  /// A line on which these bytes are sent ten times a second.
  std::unique_ptr<SerialPort> addStranger(const std::string& line,
                                          std::vector<std::uint8_t> bytes) {
    auto port = ports.offer(line);
    strangers.push_back(port.get());
    loop.every(100'000, loop.now(), [this, i = strangers.size() - 1, bytes] {
      if (strangers[i] != nullptr) static_cast<void>(strangers[i]->write(bytes));
    });
    return port;
  }

  template <class Message>
  static std::vector<std::uint8_t> encoded(const Message& message) {
    wire::Frame frame;
    wire::pack(message, 1, frame);
    std::vector<std::uint8_t> bytes(wire::kMaxFrame);
    bytes.resize(wire::encode(frame, bytes.data()));
    return bytes;
  }

  /// Changes a frame to another protocol version: the version is the byte after the COBS code, and
  /// the CRC is computed again.
  static std::vector<std::uint8_t> ofVersion(std::uint8_t version) {
    const std::uint8_t raw[] = {version, 0x82, 1, 1, 9};
    const std::uint16_t sum = wire::crc16(raw, sizeof raw);
    return {0,
            8,
            version,
            0x82,
            1,
            1,
            9,
            static_cast<std::uint8_t>(sum & 0xFF),
            static_cast<std::uint8_t>(sum >> 8),
            0};
  }

  void run(double seconds) { loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6)); }

  VirtualLoop loop;
  MemorySerial ports{loop};
  std::deque<WireRobot> wire_robots;
  std::vector<SerialPort*> strangers;
  RobotLink first{link(1)};
  RobotLink second{link(2)};
  std::vector<std::string> notes;
  bool keeper_runs = true;
  PortManager dut{loop,
                  ports,
                  {true, "", 38400},
                  {{kUid, &first}, {kUid + 1, &second}},
                  [this](const std::string& text) { notes.push_back(text); }};
};

TEST_F(PortManagerTest, FindsRobotsByTheirUidNotByTheirLine) {
  addRobot("b", kUid);
  addRobot("a", kUid + 1);
  run(2);
  EXPECT_EQ(dut.lineOf(first), "b");
  EXPECT_EQ(dut.lineOf(second), "a");
  EXPECT_THAT(notes, IsEmpty());
}

TEST_F(PortManagerTest, FindsARobotAgainOnALineWithAnotherName) {
  WireRobot& robot = addRobot("usb0");
  run(2);
  ASSERT_EQ(dut.lineOf(first), "usb0");
  robot.unplug();
  run(1);
  EXPECT_EQ(dut.lineOf(first), "");
  EXPECT_THAT(notes, ElementsAre(AllOf(HasSubstr("usb0: gone"), HasSubstr("robot 1 was on it"))));
  robot.plug("usb1");
  run(1);
  EXPECT_EQ(dut.lineOf(first), "usb1");
  EXPECT_EQ(first.counters().reboots, 0);
}

TEST_F(PortManagerTest, AReplugWithResetIsARestart) {
  WireRobot& robot = addRobot("usb0");
  run(2);
  robot.unplug();
  robot.boot(wire::kResetPin);
  robot.plug("usb0");
  run(2);
  EXPECT_EQ(dut.lineOf(first), "usb0");
  EXPECT_EQ(first.counters().reboots, 1);
}

TEST_F(PortManagerTest, RefusesASecondLineWithTheSameUidAndNamesBoth) {
  addRobot("a");
  run(2);
  addRobot("b");
  run(5);
  EXPECT_EQ(dut.lineOf(first), "a");
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0], AllOf(HasSubstr("b: uid 4711 of robot 1, which is on a already")));
  EXPECT_EQ(ports.open("b", 38400) != nullptr, true) << "the second line is still open";
}

TEST_F(PortManagerTest, ARobotWhoseOldLineIsDeadIsUsedOnItsNewLine) {
  WireRobot& robot = addRobot("a");
  run(2);
  robot.switchOff();  // the line stays open, as with a hub that does not report the removal
  run(2);
  addRobot("b");
  run(2);
  EXPECT_EQ(dut.lineOf(first), "b");
}

TEST_F(PortManagerTest, AnUnknownUidIsReportedOnceAndNotUsed) {
  addRobot("a", 99);
  run(30);
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0], AllOf(HasSubstr("a: a robot with uid 99"), HasSubstr("uid = 99")));
}

TEST_F(PortManagerTest, ReportsHowToStoreAMissingUid) {
  WireRobotOptions options;
  options.uid = 0;
  wire_robots.emplace_back(loop, ports, options).plug("a");
  run(3);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("--set-uid")));
}

TEST_F(PortManagerTest, ADeviceThatIsNoRobotIsReportedOnce) {
  const auto silent = ports.offer("silent");
  const auto gps = addStranger("gps", {'$', 'G', 'P', 'G', 'G', 'A', '\r', '\n'});
  addRobot("robot");
  run(40);
  EXPECT_EQ(dut.lineOf(first), "robot");
  EXPECT_THAT(
      notes, testing::UnorderedElementsAre(AllOf(HasSubstr("silent: no robot answers")),
                                           AllOf(HasSubstr("gps: "), HasSubstr("none from a robot"),
                                                 HasSubstr("38400 baud"))));
}

TEST_F(PortManagerTest, ReportsBothProtocolVersionsIfTheyDiffer) {
  const auto older = addStranger("older", ofVersion(1));  // firmware with built-in models
  run(25);
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0], AllOf(HasSubstr("older: a robot with protocol version 1"),
                              HasSubstr("this lab has version 2"), HasSubstr("flash")));
}

TEST_F(PortManagerTest, ReportsBothSchemasIfTheyDiffer) {
  wire::Hello hello;
  hello.uid = kUid;
  hello.schema = static_cast<std::uint16_t>(wire::kSchema + 1);
  hello.firmware = 0x0203;
  const auto newer = addStranger("newer", encoded(hello));
  run(25);
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0], AllOf(HasSubstr("newer: a robot with messages of schema"),
                              HasSubstr("(firmware 2.3)")));
  EXPECT_FALSE(first.isPlugged());
}

TEST_F(PortManagerTest, AHelloOfAnotherLengthHasAnotherSchema) {
  wire::Frame frame;
  frame.type = wire::Hello::kType;
  frame.size = 6;
  frame.payload[0] = 0xCD;
  frame.payload[1] = 0xAB;
  std::vector<std::uint8_t> bytes(wire::kMaxFrame);
  bytes.resize(wire::encode(frame, bytes.data()));
  const auto newer = addStranger("newer", bytes);
  run(2);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("schema abcd")));
}

TEST_F(PortManagerTest, ALineInUseIsReportedOnceAndOpenedWhenItIsFree) {
  addRobot("a");
  keeper_runs = false;
  auto other = ports.open("a", 38400);
  keeper_runs = true;
  run(10);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("a: in use by")));
  other.reset();
  run(4);
  EXPECT_EQ(dut.lineOf(first), "a");
}

TEST_F(PortManagerTest, IgnoresGarbageAndUnknownTypes) {
  WireRobot& robot = addRobot("a");
  wire::Frame unknown;
  unknown.type = 0xC7;
  unknown.size = 3;
  std::vector<std::uint8_t> unknown_bytes(wire::kMaxFrame);
  unknown_bytes.resize(wire::encode(unknown, unknown_bytes.data()));
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    run(0.05);
    std::vector<std::uint8_t> bytes(random.next() % 30);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next());
    robot.babble(i % 2 == 0 ? bytes : unknown_bytes);
  }
  run(1);
  EXPECT_EQ(dut.lineOf(first), "a");
  EXPECT_GT(first.counters().errors, 0);
  EXPECT_LT(loop.now() - first.heardUtime(), 200'000);
}

TEST_F(PortManagerTest, AnExchangedBoardIsAnotherRobot) {
  WireRobot& robot = addRobot("a");
  run(2);
  ASSERT_EQ(dut.lineOf(first), "a");
  wire::Hello hello;
  hello.schema = wire::kSchema;
  hello.uid = kUid + 1;
  hello.boot_id = 77;
  robot.switchOff();
  robot.unplug();
  auto line = ports.offer("a");
  run(2);
  static_cast<void>(line->write(encoded(hello)));
  run(0.1);
  EXPECT_FALSE(first.isPlugged());
  EXPECT_TRUE(second.isPlugged());
  hello.uid = kUid;  // on an adapter that stayed plugged in
  static_cast<void>(line->write(encoded(hello)));
  run(0.1);
  EXPECT_TRUE(first.isPlugged());
  EXPECT_FALSE(second.isPlugged());
}

TEST_F(PortManagerTest, SendsNothingToABootloader) {
  std::size_t bytes = 0;
  auto line = ports.offer("a");
  line->onReadable([&] {
    std::array<std::uint8_t, 64> buffer;
    bytes += line->read(buffer);
  });
  run(2.4);
  EXPECT_EQ(bytes, 0U);
  run(1);
  EXPECT_GT(bytes, 0U);
}

TEST_F(PortManagerTest, SurvivesManyReplugsWithTraffic) {
  WireRobot& a = addRobot("a", kUid);
  WireRobot& b = addRobot("b", kUid + 1);
  for (int i = 0; i < 200; ++i) {
    run(2.0);
    ASSERT_TRUE(first.isPlugged()) << "cycle " << i;
    ASSERT_TRUE(second.isPlugged()) << "cycle " << i;
    a.unplug();
    b.unplug();
    if (i % 3 == 0) a.boot(wire::kResetPower);
    if (i % 5 == 0) run(0.3);
    a.plug(i % 2 == 0 ? "b" : "a");
    b.plug(i % 2 == 0 ? "a" : "b");
  }
  run(2);
  EXPECT_EQ(first.hello()->uid, kUid);
  EXPECT_EQ(second.hello()->uid, kUid + 1);
  EXPECT_EQ(first.counters().reboots, 67);
}

}  // namespace
}  // namespace lab::bridge
