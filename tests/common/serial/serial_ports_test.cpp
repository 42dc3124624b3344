// Common properties of both kinds of lines: in memory and as pseudo terminals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/loop/asio_loop.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "common/serial/serial_devices.hpp"
#include "tests/support/loop_until.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::serial_ports_test {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

/// One kind of lines, with its loop.
class Lines {
 public:
  virtual ~Lines() = default;
  virtual SerialPorts& ports() = 0;
  /// Runs the loop until `done`, with a time limit.
  /// @return whether `done` became true
  virtual bool until(const std::function<bool()>& done) = 0;
};

class LinesInMemory final : public Lines {
 public:
  SerialPorts& ports() override { return ports_; }
  bool until(const std::function<bool()>& done) override {
    loop_.runUntil(loop_.now() + 1'000'000);
    return done();
  }

 private:
  VirtualLoop loop_;
  MemorySerial ports_{loop_};
};

class LiveLines final : public Lines {
 public:
  SerialPorts& ports() override { return ports_; }
  bool until(const std::function<bool()>& done) override { return loopUntil(loop_, done); }

 private:
  TemporaryFolder folder_;
  AsioLoop loop_;
  SerialDevices ports_{loop_, folder_ / "ports"};
  std::function<bool()> done_;
  std::int64_t deadline_ = 0;
};

std::string readAll(SerialPort& port) {
  std::string text;
  std::array<std::uint8_t, 8> bytes{};
  while (const std::size_t count = port.read(bytes))
    text.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  return text;
}

std::size_t write(SerialPort& port, const std::string& text) {
  return port.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

class SerialPortsTest : public testing::TestWithParam<bool> {
 protected:
  SerialPortsTest() {
    if (GetParam()) {
      lines_ = std::make_unique<LiveLines>();
    } else {
      lines_ = std::make_unique<LinesInMemory>();
    }
  }
  SerialPorts& dut() { return lines_->ports(); }
  bool until(const std::function<bool()>& done) { return lines_->until(done); }

  /// The robot's end of a line; received bytes go to `at_robot`.
  std::unique_ptr<SerialPort> robot(const std::string& name) {
    auto port = dut().offer(name);
    port->onReadable([this, &port = *port] { at_robot += readAll(port); });
    return port;
  }
  std::unique_ptr<SerialPort> host() {
    auto port = dut().open(dut().offered().at(0), 38400);
    port->onReadable([this, &port = *port] { at_host += readAll(port); });
    return port;
  }

  std::unique_ptr<Lines> lines_;
  std::string at_robot;
  std::string at_host;
};

TEST_P(SerialPortsTest, OffersALineUntilItsPortIsDestroyed) {
  EXPECT_THAT(dut().offered(), IsEmpty());
  auto b = dut().offer("robot_2");
  auto a = dut().offer("robot_1");
  EXPECT_THAT(dut().offered(), ElementsAre(EndsWith("robot_1"), EndsWith("robot_2")));
  a.reset();
  EXPECT_THAT(dut().offered(), ElementsAre(EndsWith("robot_2")));
}

TEST_P(SerialPortsTest, TransfersAllBytesInBothDirections) {
  std::string every;
  for (int i = 0; i < 256; ++i) every += static_cast<char>(i);  // also ^C, ^S, newline, 0
  const auto robot_end = robot("robot_1");
  const auto host_end = host();
  EXPECT_EQ(write(*host_end, every), every.size());
  EXPECT_TRUE(until([&] { return at_robot.size() >= every.size(); }));
  EXPECT_EQ(at_robot, every);
  EXPECT_EQ(write(*robot_end, every), every.size());
  EXPECT_TRUE(until([&] { return at_host.size() >= every.size(); }));
  EXPECT_EQ(at_host, every);
  EXPECT_EQ(at_robot, every) << "the line echoes";
}

TEST_P(SerialPortsTest, LosesBytesWithoutHost) {
  const auto robot_end = robot("robot_1");
  EXPECT_EQ(write(*robot_end, "before"), 6U);
  auto host_end = host();
  EXPECT_EQ(write(*robot_end, "1"), 1U);
  EXPECT_TRUE(until([&] { return !at_host.empty(); }));
  host_end.reset();
  EXPECT_EQ(write(*robot_end, "between"), 7U);
  host_end = host();
  EXPECT_EQ(write(*robot_end, "2"), 1U);
  EXPECT_TRUE(until([&] { return at_host.size() >= 2; }));
  EXPECT_EQ(at_host, "12");
}

TEST_P(SerialPortsTest, ARobotDoesNotWaitForAHostThatDoesNotRead) {
  const auto robot_end = robot("robot_1");
  const auto host_end = dut().open(dut().offered().at(0), 38400);
  const std::string much(1000, 'x');
  for (int i = 0; i < 100; ++i) EXPECT_EQ(write(*robot_end, much), much.size());
  EXPECT_LT(readAll(*host_end).size(), 100 * much.size());
}

TEST_P(SerialPortsTest, AHostWritesOnlyWhatTheRobotsQueueTakes) {
  const auto robot_end = dut().offer("robot_1");
  const auto host_end = dut().open(dut().offered().at(0), 38400);
  const std::string much(1000, 'x');
  std::size_t taken = 0;
  for (int i = 0; i < 100; ++i) taken += write(*host_end, much);
  EXPECT_GT(taken, 0U);
  EXPECT_LT(taken, 100 * much.size());
}

TEST_P(SerialPortsTest, DiscardsWaitingBytesWhenOpened) {
  const auto robot_end = robot("robot_1");
  auto host_end = dut().open(dut().offered().at(0), 38400);
  EXPECT_EQ(write(*robot_end, "unread"), 6U);
  host_end.reset();
  host_end = host();
  EXPECT_EQ(write(*robot_end, "new"), 3U);
  EXPECT_TRUE(until([&] { return at_host.size() >= 3; }));
  EXPECT_EQ(at_host, "new");
}

TEST_P(SerialPortsTest, OpensALineOnlyOnce) {
  const auto robot_end = robot("robot_1");
  const std::string path = dut().offered().at(0);
  auto first = dut().open(path, 38400);
  try {
    static_cast<void>(dut().open(path, 38400));
    FAIL() << "opened twice";
  } catch (const SerialError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path));
    EXPECT_THAT(error.what(), HasSubstr("in use by"));
  }
  first.reset();
  EXPECT_NO_THROW(first = dut().open(path, 38400));
}

TEST_P(SerialPortsTest, ReportsAMissingLine) {
  try {
    static_cast<void>(dut().open("/nowhere/robot_9", 38400));
    FAIL() << "opened";
  } catch (const SerialError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/robot_9: not there"));
  }
}

TEST_P(SerialPortsTest, TellsAHostThatItsLineIsGone) {
  auto robot_end = robot("robot_1");
  auto host_end = dut().open(dut().offered().at(0), 38400);
  std::string found;
  host_end->onReadable([&] {
    try {
      static_cast<void>(readAll(*host_end));
    } catch (const SerialError& error) {
      found = error.what();
      host_end.reset();  // from its own callback
    }
  });
  robot_end.reset();
  EXPECT_TRUE(until([&] { return !found.empty(); }));
  EXPECT_THAT(found, HasSubstr("gone"));
  EXPECT_FALSE(host_end);
}

TEST_P(SerialPortsTest, WritingToAVanishedLineThrows) {
  auto robot_end = robot("robot_1");
  const auto host_end = dut().open(dut().offered().at(0), 38400);
  robot_end.reset();
  EXPECT_THROW(static_cast<void>(write(*host_end, "x")), SerialError);
}

TEST_P(SerialPortsTest, SurvivesRepeatedReconnection) {
  const auto robot_end = robot("robot_1");
  for (int i = 0; i < 20; ++i) {
    at_robot.clear();
    auto host_end = host();
    write(*host_end, "hello");
    EXPECT_TRUE(until([&] { return at_robot.size() >= 5; })) << "plug " << i;
    EXPECT_EQ(at_robot, "hello");
    host_end.reset();
    if (i % 2 == 0) until([] { return true; });  // the robot notices it only sometimes
  }
}

TEST_P(SerialPortsTest, RefusesTwoLinesWithOneName) {
  auto first = dut().offer("robot_1");
  EXPECT_THROW(static_cast<void>(dut().offer("robot_1")), SerialError);
  first.reset();
  EXPECT_NO_THROW(first = dut().offer("robot_1"));
}

TEST_P(SerialPortsTest, FindsLinesByPattern) {
  const auto a = dut().offer("robot_1");
  const auto b = dut().offer("robot_2");
  const auto c = dut().offer("other");
  const std::string first = dut().offered().at(1);
  const std::string pattern = first.substr(0, first.size() - 1) + "?";
  EXPECT_THAT(dut().matching(pattern + " " + first),
              ElementsAre(EndsWith("robot_1"), EndsWith("robot_2")));
  EXPECT_THAT(dut().matching(first + "x"), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Of, SerialPortsTest, testing::Values(false, true),
                         [](const auto& kind) { return kind.param ? "Terminals" : "Memory"; });

}  // namespace
}  // namespace lab::serial_ports_test
