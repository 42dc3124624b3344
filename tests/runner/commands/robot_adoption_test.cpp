#include "runner/commands/robot_adoption.hpp"

#include <gmock/gmock.h>

#include <array>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "tests/support/robot_on_bench.hpp"

namespace lab::runner {
namespace {

/// A robot on an in-memory serial line; its firmware runs every millisecond of virtual time.
class RobotAdoptionTest : public testing::Test {
 protected:
  void switchOn(std::int64_t after_us = 0) {
    loop_.at(loop_.now() + after_us, [this] {
      firmware::BootFacts facts;
      facts.baud = 38400;
      device_.emplace(board_, facts);
      boot_us_ = loop_.now();
      device_->boot(0);
    });
    loop_.every(1000, loop_.now() + after_us + 1000, [this] { passMs(); });
  }

  RobotAdoption::Result adopt(std::uint32_t fresh_uid) {
    RobotAdoption::Result result;
    result.problem = "never ended";
    RobotAdoption adoption(loop_, ports_.open("robot", 38400), fresh_uid,
                           [&](const RobotAdoption::Result& outcome) {
                             result = outcome;
                             loop_.stop();
                           });
    loop_.run();
    return result;
  }

  VirtualLoop loop_;
  MemorySerial ports_{loop_};
  firmware::BenchBoard board_;
  std::optional<firmware::Device> device_;
  std::unique_ptr<SerialPort> line_ = ports_.offer("robot");
  int lost_frames_ = 0;
  int received_frames_ = 0;

 private:
  void passMs() {
    const auto now_ms = static_cast<std::uint32_t>((loop_.now() - boot_us_) / 1000);
    std::array<std::uint8_t, 256> bytes{};
    for (std::size_t n = line_->read(bytes); n > 0; n = line_->read(bytes)) {
      ++received_frames_;
      if (received_frames_ <= lost_frames_) continue;
      for (std::size_t i = 0; i < n; ++i) device_->receive(now_ms, 0, bytes[i]);
    }
    device_->tick(now_ms);
    const std::vector<std::uint8_t> sent = board_.passMs();
    (void)line_->write(sent);
  }
  std::int64_t boot_us_ = 0;
};

TEST_F(RobotAdoptionTest, AssignsAUidThatTheRobotStores) {
  switchOn(1'300'000);
  const RobotAdoption::Result result = adopt(0xA1B2C3D4);
  EXPECT_TRUE(result.ok) << result.problem;
  EXPECT_TRUE(result.uid_is_new);
  EXPECT_EQ(result.hello.uid, 0xA1B2C3D4U);
  EXPECT_EQ(result.hello.firmware, firmware::kFirmwareVersion);
  firmware::Settings stored;
  firmware::SettingsStore(board_).load(stored);
  EXPECT_EQ(stored.uid, 0xA1B2C3D4U);
}

TEST_F(RobotAdoptionTest, KeepsTheUidOfARobot) {
  firmware::Settings settings;
  settings.uid = 77;
  firmware::encodeStore(settings, board_.store.data());
  switchOn();
  const RobotAdoption::Result result = adopt(0xA1B2C3D4);
  EXPECT_TRUE(result.ok) << result.problem;
  EXPECT_FALSE(result.uid_is_new);
  EXPECT_EQ(result.hello.uid, 77U);
  EXPECT_EQ(received_frames_, 0) << "nothing is sent to it";
}

TEST_F(RobotAdoptionTest, RepeatsLostMessages) {
  lost_frames_ = 3;
  switchOn();
  EXPECT_TRUE(adopt(5).ok);
  EXPECT_EQ(device_->settings().uid, 5U);
}

TEST_F(RobotAdoptionTest, RequestsHelloFromARobotThatHasAHost) {
  firmware::Settings settings;
  settings.uid = 78;
  firmware::encodeStore(settings, board_.store.data());
  switchOn();
  loop_.at(loop_.now() + 1, [this] {  // after a message from a host it sends no HELLO by itself
    wire::Frame frame;
    wire::pack(wire::Ping{}, 1, frame);
    std::array<std::uint8_t, wire::kMaxFrame> bytes{};
    const std::uint8_t size = wire::encode(frame, bytes.data());
    for (std::uint8_t i = 0; i < size; ++i) device_->receive(0, 0, bytes[i]);
    (void)board_.passMs();
  });
  EXPECT_EQ(adopt(5).hello.uid, 78U);
}

TEST_F(RobotAdoptionTest, ReportsAFailingEeprom) {
  board_.store_dead = true;
  switchOn();
  const RobotAdoption::Result result = adopt(5);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.problem,
            "the robot refuses to store the new uid: writing its EEPROM failed (status 6)");
}

TEST_F(RobotAdoptionTest, ReportsTheTimeoutOfASilentLine) {
  const std::int64_t start = loop_.now();
  const RobotAdoption::Result result = adopt(5);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.problem,
            "found no answer from a robot within 10 s; check its power and the speed of the line "
            "(--robot-baud)");
  EXPECT_EQ(loop_.now() - start, 10'000'000);
}

TEST_F(RobotAdoptionTest, ReportsBytesThatAreNoFrames) {
  loop_.every(100'000, loop_.now(), [this] {
    const std::array<std::uint8_t, 6> garbage{0, 7, 7, 7, 7, 0};
    (void)line_->write(garbage);
  });
  EXPECT_EQ(adopt(5).problem.substr(0, 41), "found bytes that are no frames of a robot");
}

TEST_F(RobotAdoptionTest, ReportsAnotherSchema) {
  loop_.at(loop_.now() + 1000, [this] {
    wire::Hello hello;
    hello.schema = 0x1234;
    wire::Frame frame;
    wire::pack(hello, 0, frame);
    std::array<std::uint8_t, wire::kMaxFrame> bytes{};
    const std::uint8_t size = wire::encode(frame, bytes.data());
    (void)line_->write(std::span(bytes).first(size));
  });
  const RobotAdoption::Result result = adopt(5);
  EXPECT_FALSE(result.ok);
  EXPECT_EQ(result.problem.substr(0, 37), "the robot uses protocol schema 0x1234");
}

TEST_F(RobotAdoptionTest, ReportsALostLine) {
  loop_.at(loop_.now() + 1'000'000, [this] { line_.reset(); });
  const RobotAdoption::Result result = adopt(5);
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.problem, testing::HasSubstr("gone"));
}

TEST(RandomUid, IsOutsideTheRangeOfSimulatedRobots) {
  std::set<std::uint32_t> uids;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t uid = randomUid();
    EXPECT_NE(uid, 0U);
    EXPECT_NE(uid >> 24, simulatedUid(0) >> 24);
    uids.insert(uid);
  }
  EXPECT_GT(uids.size(), 990U);
}

}  // namespace
}  // namespace lab::runner
