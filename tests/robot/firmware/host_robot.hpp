/// The firmware on the host, for comparisons of its holds.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "robot/firmware/device.hpp"
#include "robot/wire/fields.hpp"

namespace lab::firmware {

/// A robot with a line of unlimited speed.
class HostRobot final : public Board {
 public:
  explicit HostRobot(const std::vector<std::uint8_t>& image) : device_(*this, BootFacts{}) {
    std::copy(image.begin(), image.end(), store_.begin());
    device_.boot(0);
  }

  void setMotors(std::int16_t left, std::int16_t right) override {
    left_ = left;
    right_ = right;
  }
  bool send(const std::uint8_t* bytes, std::uint8_t size) override {
    wire::Step step;
    wire::Ack ack;
    for (std::uint8_t i = 0; i < size; ++i) {
      if (!decoder_.push(bytes[i])) continue;
      if (wire::unpack(decoder_.frame(), step)) steps_.push_back(step);
      if (wire::unpack(decoder_.frame(), ack) && ack.status != wire::kOk) ++refusals_;
    }
    return true;
  }
  bool lineIdle() const override { return true; }
  std::uint8_t readStore(std::uint16_t address) const override { return store_.at(address); }
  void writeStore(std::uint16_t address, std::uint8_t byte) override { store_.at(address) = byte; }
  std::uint16_t stackLeft() const override { return 100; }

  /// Runs for one millisecond.
  void tick(const dynamics::Sensors& sensors) {
    ++now_;
    scanned_ = device_.scanDue(now_);
    if (scanned_) device_.sense(now_, sensors);
    device_.tick(now_);
  }

  /// Whether the last millisecond had a scan of the sensors.
  bool scanned() const { return scanned_; }

  template <class Message>
  void receive(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    std::uint8_t bytes[wire::kMaxFrame];
    const std::uint8_t size = wire::encode(frame, bytes);
    for (std::uint8_t i = 0; i < size; ++i) device_.receive(now_, 0, bytes[i]);
  }

  std::vector<wire::Step>& steps() { return steps_; }
  const Device& device() const { return device_; }
  std::uint32_t now() const { return now_; }
  std::int16_t left() const { return left_; }
  std::int16_t right() const { return right_; }
  int refusals() const { return refusals_; }

 private:
  Device device_;
  std::array<std::uint8_t, kStoreSize> store_{};
  wire::Decoder decoder_;
  std::vector<wire::Step> steps_;
  std::uint32_t now_ = 0;
  std::uint8_t seq_ = 0;
  std::int16_t left_ = 0;
  std::int16_t right_ = 0;
  int refusals_ = 0;
  bool scanned_ = false;
};

}  // namespace lab::firmware
