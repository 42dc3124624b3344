/// The firmware of a robot on a serial line, for tests: electronics, UART, and errors on the line.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/loop/loop.hpp"
#include "common/math/random.hpp"
#include "common/serial/serial.hpp"
#include "robot/firmware/device.hpp"
#include "robot/firmware/settings.hpp"

namespace lab::bridge {

/// Options of the robot and its line.
struct WireRobotOptions {
  int baud = 38400;
  std::uint32_t uid = 0;
  double clock_rate = 1;             ///< rate of the robot's clock relative to the host's
  std::uint32_t clock_start_ms = 0;  ///< its reading at boot
  std::int64_t delay_us = 0;         ///< delay of bytes to the robot
  double bit_error_rate = 0;         ///< per bit, in both directions
  std::uint64_t error_seed = 1;
};

/// Runs once per millisecond of the loop. Bytes pass the line at its baud rate.
class WireRobot {
 public:
  WireRobot(Loop& loop, SerialPorts& ports, const WireRobotOptions& options)
      : loop_(loop), ports_(ports), options_(options), noise_(options.error_seed), board_(*this) {
    begin();
    loop_.every(1000, loop_.now() + 1000, [this] { runMillisecond(); });
  }

  void plug(const std::string& name) { port_ = ports_.offer(name); }
  void unplug() { port_.reset(); }

  /// Boots for the first time, with a new EEPROM.
  void begin() {
    firmware::Settings settings;
    settings.uid = options_.uid;
    store_.fill(0xFF);
    firmware::encodeStore(settings, store_.data());
    boot(wire::kResetPower);
  }

  /// Restarts the firmware, as after a reset.
  void boot(std::uint8_t cause) {
    firmware::BootFacts facts;
    facts.reset_cause = cause;
    facts.board = 2;
    facts.baud = static_cast<std::uint32_t>(options_.baud);
    to_line_.clear();
    to_robot_.clear();
    booted_utime_ = loop_.now();
    device_.emplace(board_, facts);
    device_->boot(nowMs());
  }
  void switchOff() { device_.reset(); }
  /// Drops the bytes that are not sent yet.
  void loseOutput() { to_line_.clear(); }

  /// Sends these bytes before the next frame of the firmware.
  void babble(const std::vector<std::uint8_t>& bytes) {
    to_line_.insert(to_line_.end(), bytes.begin(), bytes.end());
  }

  [[nodiscard]] const firmware::Device& device() const { return *device_; }
  [[nodiscard]] std::int16_t left() const { return left_; }
  [[nodiscard]] std::int16_t right() const { return right_; }
  [[nodiscard]] dynamics::CoreReport report() const { return device_->core().report(); }
  [[nodiscard]] WireRobotOptions& options() { return options_; }
  dynamics::Sensors& sensors() { return sensors_; }
  /// Host time of a reading of its clock.
  [[nodiscard]] std::int64_t utimeOf(std::uint32_t ms) const {
    return booted_utime_ +
           static_cast<std::int64_t>((ms - options_.clock_start_ms) * 1000.0 / options_.clock_rate);
  }
  [[nodiscard]] std::uint32_t nowMs() const {
    const double passed = static_cast<double>(loop_.now() - booted_utime_) * options_.clock_rate;
    return options_.clock_start_ms + static_cast<std::uint32_t>(passed / 1000);
  }
  /// Called with each byte that reaches the robot.
  std::function<void(std::uint8_t)> on_byte = [](std::uint8_t) {};

 private:
  class Board final : public firmware::Board {
   public:
    explicit Board(WireRobot& robot) : robot_(robot) {}
    void setMotors(std::int16_t left, std::int16_t right) override {
      robot_.left_ = left;
      robot_.right_ = right;
    }
    bool send(const std::uint8_t* bytes, std::uint8_t size) override {
      if (robot_.to_line_.size() + size > 127) return false;
      robot_.to_line_.insert(robot_.to_line_.end(), bytes, bytes + size);
      return true;
    }
    bool lineIdle() const override { return robot_.to_line_.empty(); }
    std::uint8_t readStore(std::uint16_t address) const override {
      return robot_.store_.at(address);
    }
    void writeStore(std::uint16_t address, std::uint8_t byte) override {
      robot_.store_.at(address) = byte;
    }
    std::uint16_t stackLeft() const override { return 300; }

   private:
    WireRobot& robot_;
  };

  std::uint8_t damaged(std::uint8_t byte) {
    if (options_.bit_error_rate == 0) return byte;
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (noise_.uniform() < options_.bit_error_rate) {
        byte = static_cast<std::uint8_t>(byte ^ (1U << bit));
      }
    }
    return byte;
  }

  void runMillisecond() {
    if (!device_) return;
    const std::uint32_t now_ms = nowMs();
    const double bytes_per_ms = options_.baud / 10'000.0;
    receive(now_ms, bytes_per_ms);
    if (device_->scanDue(now_ms)) device_->sense(now_ms, sensors_);
    device_->tick(now_ms);
    transmit(bytes_per_ms);
  }

  void receive(std::uint32_t now_ms, double bytes_per_ms) {
    std::array<std::uint8_t, 256> bytes;
    if (port_) {
      while (const std::size_t count = port_->read(bytes)) {
        for (std::size_t i = 0; i < count; ++i)
          to_robot_.push_back({damaged(bytes[i]), loop_.now()});
      }
    }
    receive_credit_ += bytes_per_ms;
    while (!to_robot_.empty() && receive_credit_ >= 1) {
      const auto [byte, sent_utime] = to_robot_.front();
      if (loop_.now() - sent_utime < options_.delay_us) break;
      to_robot_.pop_front();
      receive_credit_ -= 1;
      on_byte(byte);
      device_->receive(now_ms, 0, byte);
    }
    receive_credit_ = to_robot_.empty() ? 0 : std::min(receive_credit_, bytes_per_ms);
  }

  void transmit(double bytes_per_ms) {
    transmit_credit_ += bytes_per_ms;
    std::vector<std::uint8_t> bytes;
    while (!to_line_.empty() && transmit_credit_ >= 1) {
      transmit_credit_ -= 1;
      bytes.push_back(damaged(to_line_.front()));
      to_line_.pop_front();
    }
    if (to_line_.empty()) transmit_credit_ = 0;
    if (port_ && !bytes.empty()) static_cast<void>(port_->write(bytes));
  }

  Loop& loop_;
  SerialPorts& ports_;
  WireRobotOptions options_;
  Random noise_;
  Board board_;
  std::array<std::uint8_t, 1024> store_{};
  std::unique_ptr<SerialPort> port_;
  std::optional<firmware::Device> device_;
  std::deque<std::pair<std::uint8_t, std::int64_t>>
      to_robot_;  ///< with the time at which they were sent
  std::deque<std::uint8_t> to_line_;
  double receive_credit_ = 0;
  double transmit_credit_ = 0;
  std::int64_t booted_utime_ = 0;
  dynamics::Sensors sensors_;
  std::int16_t left_ = 0;
  std::int16_t right_ = 0;
};

}  // namespace lab::bridge
