/// The firmware of a robot with simulated electronics, without a loop or a serial port.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "robot/firmware/device.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/fields.hpp"
#include "tests/robot/programs.hpp"

namespace lab::firmware {

/// Simulated electronics. The UART takes bytes from a queue of the chip's size at 38400 baud; the
/// EEPROM can fail.
class BenchBoard final : public Board {
 public:
  static constexpr std::size_t kQueue = 127;
  static constexpr double kBytesPerMs = 3.84;

  void setMotors(int16_t left_duty, int16_t right_duty) override {
    left = left_duty;
    right = right_duty;
    ++motor_changes;
  }
  bool send(const uint8_t* bytes, uint8_t size) override {
    if (queue_.size() + size > kQueue) return false;
    queue_.insert(queue_.end(), bytes, bytes + size);
    return true;
  }
  bool lineIdle() const override { return queue_.empty(); }
  uint8_t readStore(uint16_t address) const override { return store.at(address); }
  void writeStore(uint16_t address, uint8_t byte) override {
    ++store_writes;
    store_busy_ms_ = store_write_ms;
    if (!store_dead) store.at(address) = byte;
  }
  bool storeBusy() const override { return store_busy_ms_ > 0; }
  uint16_t stackLeft() const override { return 320; }

  /// Advances by 1 ms. @return the bytes that the UART sent
  std::vector<uint8_t> passMs() {
    store_busy_ms_ -= 1;
    credit_ += kBytesPerMs;
    std::vector<uint8_t> bytes;
    while (!queue_.empty() && credit_ >= 1) {
      bytes.push_back(queue_.front());
      queue_.pop_front();
      credit_ -= 1;
    }
    if (queue_.empty()) credit_ = 0;
    return bytes;
  }

  void blockLine() { queue_.assign(kQueue, 0); }

  int16_t left = 99;
  int16_t right = 99;
  int motor_changes = 0;
  int store_writes = 0;
  double store_write_ms = 0;  ///< how long a write takes; 3.4 on the chip
  bool store_dead = false;
  std::array<uint8_t, 1024> store = [] {
    std::array<uint8_t, 1024> blank{};
    blank.fill(0xFF);
    return blank;
  }();

 private:
  std::deque<uint8_t> queue_;
  double credit_ = 0;
  double store_busy_ms_ = 0;
};

/// A frame from the robot and the time at which it was complete.
struct Heard {
  uint32_t t_ms = 0;
  wire::Frame frame;
};

/// One robot whose firmware runs every millisecond, and a host that numbers its frames.
class RobotOnBench {
 public:
  explicit RobotOnBench(uint32_t t0 = 0) : now_(t0) {}

  /// A robot with these settings in its EEPROM.
  explicit RobotOnBench(const Settings& settings) { encodeStore(settings, board_.store.data()); }

  void boot(uint8_t reset_cause = wire::kResetPower) {
    BootFacts facts;
    facts.reset_cause = reset_cause;
    facts.board = 2;
    facts.baud = 38400;
    facts.build = 0x1234ABCD;
    device_ = std::make_unique<Device>(board_, facts);
    device_->boot(now_);
  }

  /// Runs for `ms` milliseconds.
  void run(uint32_t ms) {
    for (uint32_t i = 0; i < ms; ++i) {
      ++now_;
      if (device_->scanDue(now_)) device_->sense(now_, sensors_);
      device_->tick(now_);
      hear();
    }
  }

  /// Sends a message with the next seq, all bytes at once. @return the seq
  template <class Message>
  uint8_t send(const Message& message) {
    sendAgain(message, ++seq_);
    return seq_;
  }

  template <class Message>
  void sendAgain(const Message& message, uint8_t seq) {
    wire::Frame frame;
    wire::pack(message, seq, frame);
    sendFrame(frame);
  }

  void sendFrame(const wire::Frame& frame) {
    uint8_t bytes[wire::kMaxFrame];
    const uint8_t size = wire::encode(frame, bytes);
    for (uint8_t i = 0; i < size; ++i) device_->receive(now_, 250, bytes[i]);
  }

  /// Sends a command, runs for 60 ms, and up to `ms` until the answer comes. @return the answer; a
  /// missing answer is a test failure
  template <class Message>
  wire::Ack command(const Message& message, uint32_t ms = 60) {
    std::size_t at = heard_.size();
    const uint8_t seq = send(message);
    run(60);
    for (uint32_t waited = 60; waited <= ms; ++waited) {
      for (; at < heard_.size(); ++at) {
        wire::Ack ack;
        if (heard_[at].frame.seq == seq && wire::unpack(heard_[at].frame, ack)) return ack;
      }
      if (waited < ms) run(1);
    }
    ADD_FAILURE() << "no answer to type " << int{Message::kType};
    return {};
  }

  /// All messages of a type received so far, oldest first.
  template <class Message>
  std::vector<Message> all() const {
    std::vector<Message> messages;
    for (const Heard& heard : heard_) {
      Message message;
      if (wire::unpack(heard.frame, message)) messages.push_back(message);
    }
    return messages;
  }

  /// The latest message of a type; a missing one is a test failure.
  template <class Message>
  Message last() const {
    const std::vector<Message> messages = all<Message>();
    if (messages.empty()) {
      ADD_FAILURE() << "no message of type " << int{Message::kType};
      return {};
    }
    return messages.back();
  }

  std::vector<int> eventCodes() const {
    std::vector<int> codes;
    for (const wire::Event& event : all<wire::Event>()) codes.push_back(event.code);
    return codes;
  }

  /// Loads a program. @return the answer to the last message sent
  wire::Ack load(const std::vector<uint8_t>& code) {
    const auto size = static_cast<uint8_t>(code.size());
    const uint32_t hash = dynamics::programHash(code.data(), size);
    wire::Ack ack = command(wire::LoadBegin{hash, size});
    for (std::size_t at = 0; at < code.size() && ack.status == wire::kOk; at += 32) {
      wire::LoadData data;
      data.offset = static_cast<uint8_t>(at);
      std::copy(code.begin() + static_cast<std::ptrdiff_t>(at),
                code.begin() + static_cast<std::ptrdiff_t>(std::min(at + 32, code.size())),
                data.code);
      ack = command(data);
    }
    return ack.status == wire::kOk ? command(wire::LoadEnd{hash}, 1000) : ack;
  }

  /// Writes a program into the EEPROM, to be found at the next boot.
  void store(uint8_t place, uint32_t hash) {
    const std::vector<uint8_t>& code = testPrograms().code(hash);
    encodeProgram(code.data(), static_cast<uint8_t>(code.size()), place, board_.store.data());
  }

  /// Stages the programs, loads those that the robot lacks, sends the other settings and applies
  /// them. @return the answer to APPLY
  wire::Ack configure(const dynamics::CoreSettings& settings) {
    for (uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      EXPECT_EQ(command(wire::programMessage(settings, slot)).status, wire::kOk);
    }
    for (const uint32_t hash : settings.programs) {
      if (hash != 0 && device_->programs().placeOf(hash) == ProgramStore::kNoPlace) {
        EXPECT_EQ(load(testPrograms().code(hash)).status, wire::kOk);
      }
    }
    EXPECT_EQ(command(wire::lightMessage(settings)).status, wire::kOk);
    EXPECT_EQ(command(wire::motionMessage(settings)).status, wire::kOk);
    wire::Apply apply;
    apply.config = wire::configCrc(settings);
    config_ = apply.config;
    return command(apply);
  }

  wire::Order order(uint8_t mode, uint32_t lease_ms, uint8_t id = 1) const {
    wire::Order order;
    order.id = id;
    order.mode = mode;
    order.config = config_;
    order.left_um_s = 100000;
    order.right_um_s = -50000;
    order.lease_ms = lease_ms;
    return order;
  }

  Device& device() { return *device_; }
  BenchBoard& board() { return board_; }
  dynamics::Sensors& sensors() { return sensors_; }
  uint32_t now() const { return now_; }
  std::vector<Heard>& heard() { return heard_; }
  bool stands() const { return board_.left == 0 && board_.right == 0; }

 private:
  void hear() {
    for (const uint8_t byte : board_.passMs()) {
      if (decoder_.push(byte)) heard_.push_back({now_, decoder_.frame()});
    }
  }

  uint32_t now_ = 0;
  BenchBoard board_;
  std::unique_ptr<Device> device_;
  dynamics::Sensors sensors_;
  wire::Decoder decoder_;
  std::vector<Heard> heard_;
  uint8_t seq_ = 0;
  uint16_t config_ = 0;
};

/// ABP in slot 0 for light 0..512, RTP in slot 1 for light above.
inline dynamics::CoreSettings twoPrograms() {
  dynamics::CoreSettings s;
  s.light.count = 2;
  s.light.bands[0] = dynamics::LightBand{0, 512, 0};
  s.light.bands[1] = dynamics::LightBand{512, 1024, 1};
  s.programs[0] = hashOf(abpText("6 cm/s", "0.5 s", "3 rad/s"));
  s.programs[1] = hashOf(rtpText("5 cm/s", "1 1/s", "0.5 s"));
  return s;
}

/// Boots and configures a robot with twoPrograms(); it runs ABP under a lease.
inline void startPrograms(RobotOnBench& robot, uint32_t lease_ms) {
  const dynamics::CoreSettings settings = twoPrograms();
  robot.store(0, settings.programs[0]);
  robot.store(1, settings.programs[1]);
  robot.boot();
  EXPECT_EQ(robot.configure(twoPrograms()).status, wire::kOk);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, lease_ms)).status, wire::kOk);
}

}  // namespace lab::firmware
