/// A simulated chip with the firmware binary, and a host that communicates with it without delay.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "robot/firmware/settings.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/fields.hpp"
#include "sim_svc/emulator/chip.hpp"

namespace lab::emulator {

inline constexpr double kCyclesPerMs = kChipHz / 1000;
inline constexpr std::uint32_t kTestUid = 0x51000042;
inline constexpr std::uint32_t kLongLease = 1U << 30U;

inline std::shared_ptr<const FirmwareImage> shippedProgram() {
  static const auto program = std::make_shared<const FirmwareImage>(LAB_FIRMWARE_ELF);
  return program;
}

inline std::vector<std::uint8_t> storeWith(const firmware::Settings& settings) {
  std::vector<std::uint8_t> image(firmware::kStoreSize, 0xFF);
  firmware::encodeStore(settings, image.data());
  return image;
}

inline std::vector<std::uint8_t> storeWithUid(std::uint32_t uid) {
  firmware::Settings settings;
  settings.uid = uid;
  return storeWith(settings);
}

/// A frame and the time at which its last stop bit ended.
struct Heard {
  double ms = 0;
  wire::Frame frame;
};

template <class Message>
struct HeardMessage {
  double ms = 0;
  std::uint8_t seq = 0;
  Message message;
};

class RobotOnChip {
 public:
  explicit RobotOnChip(const ChipSettings& settings = {},
                       std::vector<std::uint8_t> eeprom = storeWithUid(kTestUid))
      : chip_(shippedProgram(), settings) {
    chip_.loadEeprom(eeprom);
    light(512);
  }

  Chip& chip() { return chip_; }
  double now() const { return ms_; }

  void light(std::uint16_t counts) {
    inputs_.light_front = inputs_.light_back = counts;
    chip_.setInputs(inputs_);
  }
  void ir(unsigned sensor, std::uint16_t counts) {
    inputs_.ir.at(sensor) = counts;
    chip_.setInputs(inputs_);
  }

  /// Switches on and sends a frame; returns when it has booted and sends telemetry.
  void start() {
    chip_.switchOn();
    run(20);
    command(wire::SetParam{wire::kStepLog, 0});
  }

  void run(double ms, double slice_ms = 2) {
    const double end = ms_ + ms;
    while (ms_ < end) {
      ms_ = std::min(ms_ + slice_ms, end);
      const auto cycle = static_cast<std::uint64_t>(std::llround(ms_ * kCyclesPerMs));
      chip_.runTo(cycle);
      for (const SentByte& sent : chip_.takeSent(cycle)) {
        bytes_.push_back(sent);
        if (decoder_.push(sent.value)) {
          heard_.push_back({static_cast<double>(sent.cycle) / kCyclesPerMs, decoder_.frame()});
        }
      }
      for (const DutyChange& change : chip_.takeChanges(cycle)) {
        changes_.push_back(change);
      }
    }
  }

  template <class Message>
  std::uint8_t send(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    sendFrame(frame);
    return seq_;
  }
  void sendFrame(const wire::Frame& frame) {
    std::uint8_t bytes[wire::kMaxFrame];
    const std::uint8_t size = wire::encode(frame, bytes);
    chip_.receive(std::span<const std::uint8_t>(bytes, size));
  }

  /// Sends a command and returns the answer; the test fails if there is none.
  template <class Message>
  wire::Ack command(const Message& message, double timeout_ms = 500) {
    const std::size_t before = heard_.size();
    const std::uint8_t seq = send(message);
    const double end = ms_ + timeout_ms;
    std::size_t at = before;
    while (ms_ < end) {
      run(1, 1);
      for (; at < heard_.size(); ++at) {
        wire::Ack ack;
        if (heard_[at].frame.seq == seq && wire::unpack(heard_[at].frame, ack) &&
            ack.type == Message::kType) {
          return ack;
        }
      }
    }
    ADD_FAILURE() << "no answer to message " << int{Message::kType} << " within " << timeout_ms
                  << " ms";
    return {0, 255, 255};
  }

  /// Stages and applies settings, which the chip must accept.
  void configure(const dynamics::CoreSettings& settings) {
    for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      EXPECT_EQ(command(wire::programMessage(settings, slot)).status, wire::kOk);
    }
    EXPECT_EQ(command(wire::lightMessage(settings)).status, wire::kOk);
    EXPECT_EQ(command(wire::motionMessage(settings)).status, wire::kOk);
    config_ = wire::configCrc(settings);
    EXPECT_EQ(command(wire::Apply{config_}).status, wire::kOk);
  }

  wire::Order order(std::uint8_t mode, std::uint32_t lease_ms = kLongLease) {
    wire::Order order;
    order.id = ++order_id_;
    order.mode = mode;
    order.config = config_;
    order.lease_ms = lease_ms;
    return order;
  }

  template <class Message>
  std::vector<HeardMessage<Message>> all(double from_ms = 0) const {
    std::vector<HeardMessage<Message>> found;
    Message message;
    for (const Heard& heard : heard_) {
      if (heard.ms >= from_ms && wire::unpack(heard.frame, message)) {
        found.push_back({heard.ms, heard.frame.seq, message});
      }
    }
    return found;
  }

  template <class Message>
  std::optional<Message> last() const {
    const auto found = all<Message>();
    return found.empty() ? std::nullopt : std::optional<Message>(found.back().message);
  }

  bool hadEvent(wire::EventCode code, double from_ms = 0) const {
    for (const auto& event : all<wire::Event>(from_ms)) {
      if (event.message.code == code) return true;
    }
    return false;
  }

  const std::vector<Heard>& heard() const { return heard_; }
  const std::vector<SentByte>& bytes() const { return bytes_; }
  const std::vector<DutyChange>& changes() const { return changes_; }
  void forget() {
    heard_.clear();
    bytes_.clear();
    changes_.clear();
  }

 private:
  Chip chip_;
  AnalogInputs inputs_;
  double ms_ = 0;
  wire::Decoder decoder_;
  std::vector<Heard> heard_;
  std::vector<SentByte> bytes_;
  std::vector<DutyChange> changes_;
  std::uint8_t seq_ = 0;
  std::uint8_t order_id_ = 0;
  std::uint16_t config_ = 0;
};

/// The four programs of the paper in four light bands: dark to bright ABP, noisy ABP, BP, RTP.
inline dynamics::CoreSettings fourPrograms() {
  using namespace dynamics;
  CoreSettings settings;
  settings.programs[0].kind = kAbp;
  settings.programs[0].speed_um_s = 50000;
  settings.programs[0].amplitude_um_s = 112500;
  settings.programs[0].hold_ms = 500;
  settings.programs[1].kind = kNoisyAbp;
  settings.programs[1].speed_um_s = 10000;
  settings.programs[1].amplitude_um_s = 100000;
  settings.programs[1].hold_ms = 100;
  settings.programs[2].kind = kBp;
  settings.programs[2].amplitude_um_s = 70000;
  settings.programs[2].hold_ms = 200;
  settings.programs[3].kind = kRtp;
  settings.programs[3].speed_um_s = 50000;
  settings.programs[3].mean_run_us = 333333;
  settings.programs[3].tumble_ms = 500;
  settings.programs[3].tumble_amplitude_um_s = 235619;
  settings.light.count = 4;
  for (std::uint8_t i = 0; i < 4; ++i) {
    settings.light.bands[i].low = static_cast<std::uint16_t>(256 * i);
    settings.light.bands[i].high = static_cast<std::uint16_t>(256 * (i + 1));
    settings.light.bands[i].slot = i;
  }
  settings.light.hysteresis = 8;
  settings.reversal.enabled = false;
  return settings;
}

/// The light in the middle of the band of a slot of fourPrograms().
inline std::uint16_t lightOfSlot(unsigned slot) {
  return static_cast<std::uint16_t>(256 * slot + 128);
}

}  // namespace lab::emulator
