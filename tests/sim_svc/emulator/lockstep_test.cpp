// The emulator's answers to packets from the arena.
#include "sim_svc/emulator/lockstep.hpp"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "sim_svc/bodies/chip_link.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator::lockstep_test {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

class PacketWriter {
 public:
  PacketWriter(chip::Packet kind, std::int64_t until_us, std::uint32_t robots) {
    chip::Header header;
    header.packet = kind;
    header.until_us = until_us;
    header.robots = robots;
    add(header);
  }
  template <class Plain>
  PacketWriter& add(const Plain& value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return *this;
  }
  PacketWriter& add(const std::vector<std::uint8_t>& more) {
    for (const std::uint8_t byte : more) bytes.push_back(byte);
    return *this;
  }
  std::vector<std::uint8_t> bytes;
};

template <class Plain>
Plain take(const std::vector<std::uint8_t>& packet, std::size_t& at) {
  Plain value{};
  EXPECT_LE(at + sizeof value, packet.size());
  if (at + sizeof value <= packet.size()) std::memcpy(&value, packet.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

struct Stepped {
  chip::ChipOutput output;
  std::vector<chip::WheelChange> changes;
  std::vector<std::uint8_t> sent;
};

std::vector<Stepped> parse(const std::vector<std::uint8_t>& packet) {
  std::size_t at = 0;
  const auto header = take<chip::Header>(packet, at);
  EXPECT_EQ(header.packet, chip::Packet::kStepped);
  std::vector<Stepped> robots(header.robots);
  for (Stepped& robot : robots) {
    robot.output = take<chip::ChipOutput>(packet, at);
    for (std::uint32_t i = 0; i < robot.output.changes; ++i) {
      robot.changes.push_back(take<chip::WheelChange>(packet, at));
    }
    for (std::uint32_t i = 0; i < robot.output.tx_size; ++i) {
      robot.sent.push_back(take<std::uint8_t>(packet, at));
    }
  }
  EXPECT_EQ(at, packet.size());
  return robots;
}

PacketWriter setup(std::vector<chip::ChipSetup> robots) {
  PacketWriter packet(chip::Packet::kSetup, kStart, static_cast<std::uint32_t>(robots.size()));
  for (chip::ChipSetup& robot : robots) {
    const auto store = storeWithUid(0x51000000U + static_cast<std::uint32_t>(robot.id));
    robot.eeprom_size = static_cast<std::uint32_t>(store.size());
    packet.add(robot).add(store);
  }
  return packet;
}

/// Two robots; the second one is switched on 100 ms later and its clock is 1 % fast.
std::vector<chip::ChipSetup> twoRobots() {
  chip::ChipSetup one;
  one.id = 7;
  one.boot_us = kStart;
  chip::ChipSetup two;
  two.id = 8;
  two.boot_us = kStart + 100'000;
  two.clock_rate = 1.01;
  return {one, two};
}

/// Makes steps of 2 ms. The bytes in `rx` are sent to the first robot in the first step.
std::vector<Stepped> run(Lockstep& lockstep, std::int64_t& now, int steps,
                         std::vector<std::uint8_t> rx = {}) {
  std::vector<Stepped> all(2);
  for (int i = 0; i < steps; ++i) {
    const std::int64_t from = now;
    now += 2000;
    PacketWriter packet(chip::Packet::kStep, now, 2);
    chip::ChipInput input;
    input.light_front = input.light_back = 128;
    input.rx_size = static_cast<std::uint32_t>(rx.size());
    packet.add(input).add(std::exchange(rx, {}));
    input.rx_size = 0;
    packet.add(input);
    const auto robots = parse(lockstep.answer(packet.bytes));
    EXPECT_EQ(robots.size(), 2U);
    for (std::size_t r = 0; r < robots.size(); ++r) {
      all[r].output = robots[r].output;
      for (const auto& change : robots[r].changes) {
        EXPECT_GE(change.at_us, from);
        EXPECT_LE(change.at_us, now);
        all[r].changes.push_back(change);
      }
      all[r].sent.insert(all[r].sent.end(), robots[r].sent.begin(), robots[r].sent.end());
    }
  }
  return all;
}

template <class Message>
std::vector<Message> messagesIn(const std::vector<std::uint8_t>& bytes) {
  wire::Decoder decoder;
  std::vector<Message> found;
  Message message;
  for (const std::uint8_t byte : bytes) {
    if (decoder.push(byte) && wire::unpack(decoder.frame(), message)) found.push_back(message);
  }
  return found;
}

template <class Message>
void encodeTo(std::vector<std::uint8_t>& bytes, const Message& message) {
  static std::uint8_t seq = 0;
  wire::Frame frame;
  wire::pack(message, ++seq, frame);
  std::uint8_t encoded[wire::kMaxFrame];
  const std::uint8_t size = wire::encode(frame, encoded);
  for (std::uint8_t i = 0; i < size; ++i) bytes.push_back(encoded[i]);
}

TEST(Lockstep, RobotsBootAtTheirTimesAndSendHello) {
  Lockstep lockstep(shippedProgram());
  std::size_t at = 0;
  EXPECT_EQ(take<chip::Header>(lockstep.answer(setup(twoRobots()).bytes), at).packet,
            chip::Packet::kReady);
  std::int64_t now = kStart;
  auto robots = run(lockstep, now, 49);
  EXPECT_EQ(robots[0].output.state, chip::ChipState::kRunning);
  EXPECT_EQ(robots[1].output.state, chip::ChipState::kOff);
  EXPECT_TRUE(robots[1].sent.empty());
  ASSERT_EQ(messagesIn<wire::Hello>(robots[0].sent).size(), 1U);
  EXPECT_EQ(messagesIn<wire::Hello>(robots[0].sent)[0].uid, 0x51000007U);
  robots = run(lockstep, now, 50);
  EXPECT_EQ(robots[1].output.state, chip::ChipState::kRunning);
  ASSERT_EQ(messagesIn<wire::Hello>(robots[1].sent).size(), 1U);
  EXPECT_EQ(messagesIn<wire::Hello>(robots[1].sent)[0].uid, 0x51000008U);
}

TEST(Lockstep, OrdersReachTheWheelsAtTheRightTime) {
  Lockstep lockstep(shippedProgram());
  static_cast<void>(lockstep.answer(setup(twoRobots()).bytes));
  std::int64_t now = kStart;
  run(lockstep, now, 50);
  std::vector<std::uint8_t> rx;
  dynamics::CoreSettings settings = fourPrograms();
  std::fill(std::begin(settings.programs), std::end(settings.programs), 0U);  // it only drives
  for (std::uint8_t slot = 0; slot < 4; ++slot) encodeTo(rx, wire::programMessage(settings, slot));
  encodeTo(rx, wire::lightMessage(settings));
  encodeTo(rx, wire::motionMessage(settings));
  encodeTo(rx, wire::Apply{wire::configCrc(settings)});
  wire::Order order;
  order.mode = wire::Order::kDrive;
  order.config = wire::configCrc(settings);
  order.left_um_s = 135000;
  order.right_um_s = -135000;
  order.lease_ms = 300;
  encodeTo(rx, order);
  const std::int64_t sent_at = now;
  const auto line_us = static_cast<std::int64_t>(static_cast<double>(rx.size()) * 1e7 / 38400);
  const auto robots = run(lockstep, now, 400, rx);
  ASSERT_EQ(robots[0].changes.size(), 2U);
  EXPECT_EQ(robots[0].changes[0].left, 128);
  EXPECT_EQ(robots[0].changes[0].right, -128);
  EXPECT_NEAR(static_cast<double>(robots[0].changes[0].at_us - sent_at),
              static_cast<double>(line_us), 4000);
  EXPECT_EQ(robots[0].changes[1].left, 0);
  EXPECT_NEAR(static_cast<double>(robots[0].changes[1].at_us - robots[0].changes[0].at_us), 300'000,
              4000);
  EXPECT_TRUE(robots[1].changes.empty());
}

TEST(Lockstep, AClockThatRunsFastCountsMoreMilliseconds) {
  Lockstep lockstep(shippedProgram());
  auto settings = twoRobots();
  settings[0].clock_rate = 1.01;
  static_cast<void>(lockstep.answer(setup(settings).bytes));
  std::int64_t now = kStart;
  run(lockstep, now, 50);
  std::vector<std::uint8_t> rx;
  encodeTo(rx, wire::Ping{});
  const auto telemetry = messagesIn<wire::Telemetry>(run(lockstep, now, 5000, rx)[0].sent);
  ASSERT_GT(telemetry.size(), 190U);
  // One every 50 ms of its own clock.
  EXPECT_NEAR(static_cast<double>(telemetry.size()), 10'000 * 1.01 / 50, 2);
}

TEST(Lockstep, RefusesInvalidPacketsWithOneLine) {
  const auto errorOf = [](std::vector<std::vector<std::uint8_t>> packets) {
    Lockstep lockstep(shippedProgram());
    try {
      for (const auto& packet : packets) static_cast<void>(lockstep.answer(packet));
    } catch (const LinkError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  auto wrong_version = setup(twoRobots()).bytes;
  wrong_version[0] = 99;
  EXPECT_THAT(errorOf({wrong_version}), testing::HasSubstr("version 99; expected 1"));
  EXPECT_THAT(errorOf({PacketWriter(chip::Packet::kStep, 0, 0).bytes}),
              testing::HasSubstr("expected SETUP"));
  EXPECT_THAT(errorOf({setup(twoRobots()).bytes, setup(twoRobots()).bytes}),
              testing::HasSubstr("expected STEP"));
  auto cut = setup(twoRobots()).bytes;
  cut.pop_back();
  EXPECT_THAT(errorOf({cut}), testing::HasSubstr("1 bytes early"));
  auto longer = setup(twoRobots()).bytes;
  longer.push_back(0);
  EXPECT_THAT(errorOf({longer}), testing::HasSubstr("1 bytes too long"));
  EXPECT_THAT(errorOf({setup(twoRobots()).bytes, PacketWriter(chip::Packet::kStep, 0, 3).bytes}),
              testing::HasSubstr("a step for 3 robots; expected the 2"));
  EXPECT_THAT(errorOf({{}}), testing::HasSubstr("early"));
  auto odd_clock = twoRobots();
  odd_clock[0].clock_rate = 0;
  EXPECT_THAT(errorOf({setup(odd_clock).bytes}), testing::HasSubstr("robot 7"));
}

class Sockets {
 public:
  Sockets() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends_), 0); }
  ~Sockets() {
    closeArena();
    close(ends_[1]);
  }
  void closeArena() {
    if (ends_[0] >= 0) close(ends_[0]);
    ends_[0] = -1;
  }
  int chips() const { return ends_[1]; }
  std::vector<std::uint8_t> ask(const std::vector<std::uint8_t>& packet) const {
    EXPECT_EQ(send(ends_[0], packet.data(), packet.size(), 0), static_cast<ssize_t>(packet.size()));
    return receive();
  }
  std::vector<std::uint8_t> receive() const {
    std::vector<std::uint8_t> packet(chip::kLargestPacket);
    const ssize_t size = recv(ends_[0], packet.data(), packet.size(), 0);
    packet.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return packet;
  }

 private:
  int ends_[2] = {-1, -1};
};

TEST(Lockstep, ServesASocketUntilItIsClosed) {
  Sockets sockets;
  int code = -1;
  std::thread chips([&] { code = serveArena(sockets.chips(), LAB_FIRMWARE_ELF); });
  std::size_t at = 0;
  EXPECT_EQ(take<chip::Header>(sockets.ask(setup(twoRobots()).bytes), at).packet,
            chip::Packet::kReady);
  PacketWriter step(chip::Packet::kStep, kStart + 2000, 2);
  step.add(chip::ChipInput{}).add(chip::ChipInput{});
  EXPECT_EQ(parse(sockets.ask(step.bytes)).size(), 2U);
  sockets.closeArena();
  chips.join();
  EXPECT_EQ(code, 0);
}

TEST(Lockstep, SendsAnErrorOverTheSocket) {
  Sockets sockets;
  int code = -1;
  std::thread chips([&] { code = serveArena(sockets.chips(), "/nowhere.elf"); });
  const auto packet = sockets.receive();
  chips.join();
  EXPECT_EQ(code, 1);
  std::size_t at = 0;
  EXPECT_EQ(take<chip::Header>(packet, at).packet, chip::Packet::kFailed);
  EXPECT_THAT(std::string(packet.begin() + static_cast<std::ptrdiff_t>(at), packet.end()),
              testing::HasSubstr("/nowhere.elf: cannot be read"));
}

}  // namespace
}  // namespace lab::emulator::lockstep_test
