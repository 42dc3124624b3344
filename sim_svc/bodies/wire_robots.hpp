/// Robots on the wire without a chip: the firmware compiled for the host.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "robot/firmware/device.hpp"
#include "robot/firmware/settings.hpp"
#include "sim_svc/bodies/body_driver.hpp"
#include "sim_svc/world/robot_clock.hpp"

namespace lab::sim {

/// Initial state of one robot on the wire.
struct WireSetup {
  std::size_t body = 0;  ///< The world's robot that it drives.
  int baud = 38400;
  firmware::Settings settings;  ///< The contents of its EEPROM, including the uid.
};

/// The electronics around a firmware::Device: its own clock, which starts when the robot boots; a
/// serial line with the speed and the send buffer of the real one; an EEPROM that keeps its
/// contents during resets.
///
/// Simplifications compared with the chip (docs/bodies.md): a sensor scan happens at one point in
/// time, EEPROM writes and the program take no time, and no received byte is lost.
class WireRobot final : private firmware::Board {
 public:
  /// Capacity of the firmware's send buffer [bytes] (robot/firmware/avr/uart.cpp).
  static constexpr std::size_t kSendBuffer = 127;
  /// Capacity of the line on the host's side [bytes]; more is lost.
  static constexpr std::size_t kLineBuffer = 4096;

  /// @param boot_us when it is switched on, world time
  /// @param clock_rate of its oscillator
  WireRobot(const WireSetup& setup, std::int64_t boot_us, double clock_rate);

  [[nodiscard]] std::size_t body() const { return setup_.body; }
  void receive(std::int64_t now_us, std::span<const std::uint8_t> bytes);
  void advance(World& world, std::int64_t until_us);
  [[nodiscard]] std::span<const std::uint8_t> sent() const { return sent_; }
  [[nodiscard]] const firmware::Device& device() const { return *device_; }

  /// Presses the reset button at a world time that advance() has reached.
  void reset(std::int64_t now_us);

 private:
  void setMotors(std::int16_t left, std::int16_t right) override;
  bool send(const std::uint8_t* bytes, std::uint8_t size) override;
  [[nodiscard]] bool lineIdle() const override { return waiting_.empty(); }
  [[nodiscard]] std::uint8_t readStore(std::uint16_t address) const override;
  void writeStore(std::uint16_t address, std::uint8_t byte) override;
  [[nodiscard]] std::uint16_t stackLeft() const override;

  void switchOn(std::int64_t at_us, std::uint8_t cause);
  void receiveByte();
  void runTick(World& world);
  void sendUntil(double time_us);

  WireSetup setup_;
  double rate_;
  double byte_us_;  ///< Duration of one byte on the line.
  RobotClock clock_;
  std::uint8_t reset_cause_ = 0;
  std::optional<firmware::Device> device_;
  std::vector<std::uint8_t> store_;
  std::int64_t next_ms_ = 0;  ///< Next tick of the robot's clock; 0: not yet booted.
  double now_us_ = 0;         ///< World time.
  std::deque<std::uint8_t> incoming_;
  double received_us_ = 0;  ///< When the first byte of incoming_ is complete, world time.
  std::deque<std::uint8_t> waiting_;
  double line_free_us_ = 0;                ///< When the next byte can start, world time.
  std::optional<std::uint8_t> under_way_;  ///< The byte that is complete at line_free_us_.
  std::vector<std::uint8_t> sent_;
  std::int16_t left_ = 0;
  std::int16_t right_ = 0;
  std::vector<MotorChange> changes_;
};

/// All robots of this kind. One processor core can run hundreds of them.
class WireRobots final : public BodyDriver {
 public:
  WireRobots(const World& world, const std::vector<WireSetup>& setups);

  [[nodiscard]] std::size_t size() const override { return robots_.size(); }
  [[nodiscard]] std::size_t body(std::size_t k) const override { return robots_[k]->body(); }
  void receive(std::size_t k, std::span<const std::uint8_t> bytes) override {
    robots_[k]->receive(time_us_, bytes);
  }
  void advance(World& world, std::int64_t until_us) override;
  [[nodiscard]] std::span<const std::uint8_t> sent(std::size_t k) const override {
    return robots_[k]->sent();
  }
  [[nodiscard]] std::int64_t program(std::size_t k) const override;
  [[nodiscard]] WireRobot& robot(std::size_t k) { return *robots_[k]; }

 private:
  std::vector<std::unique_ptr<WireRobot>> robots_;
  std::int64_t time_us_ = 0;
};

}  // namespace lab::sim
