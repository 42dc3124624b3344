/// A simulated chip with the firmware binary, and a host that communicates with it without delay.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robot/firmware/program_store.hpp"
#include "robot/firmware/settings.hpp"
#include "robot/wire/config.hpp"
#include "robot/wire/fields.hpp"
#include "sim_svc/emulator/chip.hpp"
#include "tests/robot/programs.hpp"

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

/// A robot that has the programs of these settings in its EEPROM.
inline std::vector<std::uint8_t> storeWithPrograms(const dynamics::CoreSettings& settings) {
  std::vector<std::uint8_t> image = storeWithUid(kTestUid);
  for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    if (settings.programs[slot] == 0) continue;
    const std::vector<std::uint8_t>& code = testPrograms().code(settings.programs[slot]);
    firmware::encodeProgram(code.data(), static_cast<std::uint8_t>(code.size()), slot,
                            image.data());
  }
  return image;
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

  /// What the chip says of its programs.
  wire::Programs programs() {
    const double begin = ms_;
    send(wire::GetPrograms{});
    for (int i = 0; i < 200 && all<wire::Programs>(begin).empty(); ++i) run(1, 1);
    const auto found = all<wire::Programs>(begin);
    if (found.empty()) {
      ADD_FAILURE() << "no answer to GET_PROGRAMS";
      return {};
    }
    return found.back().message;
  }

  /// Loads a program. @return the answer to the last message sent
  wire::Ack load(const std::vector<std::uint8_t>& code) {
    const auto size = static_cast<std::uint8_t>(code.size());
    const std::uint32_t hash = dynamics::programHash(code.data(), size);
    wire::Ack ack = command(wire::LoadBegin{hash, size});
    for (std::size_t at = 0; at < code.size() && ack.status == wire::kOk; at += 32) {
      wire::LoadData data;
      data.offset = static_cast<std::uint8_t>(at);
      std::copy(code.begin() + static_cast<std::ptrdiff_t>(at),
                code.begin() + static_cast<std::ptrdiff_t>(std::min(at + 32, code.size())),
                data.code);
      ack = command(data);
    }
    return ack.status == wire::kOk ? command(wire::LoadEnd{hash}, 2000) : ack;
  }

  /// Loads the missing programs, stages and applies settings, which the chip must accept.
  void configure(const dynamics::CoreSettings& settings) {
    for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      EXPECT_EQ(command(wire::programMessage(settings, slot)).status, wire::kOk);
    }
    const wire::Programs stored = programs();
    for (const std::uint32_t hash : settings.programs) {
      if (hash != 0 && std::find(std::begin(stored.hash), std::end(stored.hash), hash) ==
                           std::end(stored.hash)) {
        EXPECT_EQ(load(testPrograms().code(hash)).status, wire::kOk);
      }
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

/// How often the programs of fourPrograms() draw.
struct Holds {
  std::string abp = "500 ms";
  std::string noisy_abp = "100 ms";
  std::string bp = "200 ms";
  std::string gamma = "3 1/s";
  std::string tumble = "500 ms";
};

/// The four programs of the paper in four light bands: dark to bright ABP, noisy ABP, BP, RTP.
inline dynamics::CoreSettings fourPrograms(const Holds& epsilon = {}) {
  using namespace dynamics;
  CoreSettings settings;
  settings.programs[0] = hashOf(abpText("5 cm/s", epsilon.abp, "3 rad/s"));
  settings.programs[1] = hashOf(wheelNoiseText("1 cm/s", "10 cm/s", epsilon.noisy_abp));
  settings.programs[2] = hashOf(wheelNoiseText("0 cm/s", "7 cm/s", epsilon.bp));
  language::ProgramText rtp = rtpText("5 cm/s", epsilon.gamma, "0.5 s");
  rtp.phases[1].hold = epsilon.tumble;
  settings.programs[3] = hashOf(rtp);
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
