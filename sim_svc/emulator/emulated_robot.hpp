/// A chip with its serial line, in times of the arena's clock.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim_svc/emulator/chip.hpp"
#include "sim_svc/emulator/line_faults.hpp"

namespace lab::emulator {

struct RobotSettings {
  std::vector<std::uint8_t> eeprom{};  ///< from address 0; the rest is blank
  std::int64_t boot_us = 0;            ///< when it is switched on
  double clock_rate = 1;               ///< of its oscillator relative to the arena's clock
  int line_baud = 38400;               ///< of the host's end
  LineFaultSettings line{};
  std::uint64_t seed = 1;  ///< of its RAM at power-on
};

/// A change of the motor duties at a time of the arena's clock.
struct DutyAt {
  std::int64_t at_us = 0;
  Duty duty;
};

/// Times are microseconds of the arena's clock. This class does not wait or read a clock.
class EmulatedRobot {
 public:
  EmulatedRobot(std::shared_ptr<const FirmwareImage> program, const RobotSettings& settings,
                std::int64_t now_us);

  void sense(const AnalogInputs& inputs) { chip_.setInputs(inputs); }

  /// Bytes that the host sends now.
  void receive(std::span<const std::uint8_t> bytes);

  /// Runs until `until_us`.
  void advance(std::int64_t until_us);

  /// The bytes that have reached the host by now.
  [[nodiscard]] std::vector<std::uint8_t> takeSent();

  /// The changes of the motor duties in the last advance().
  [[nodiscard]] std::vector<DutyAt> takeChanges();

  [[nodiscard]] Chip& chip() { return chip_; }
  [[nodiscard]] const Chip& chip() const { return chip_; }
  [[nodiscard]] std::int64_t now() const { return now_us_; }
  [[nodiscard]] std::uint64_t cycleAt(std::int64_t at_us) const;

 private:
  [[nodiscard]] std::int64_t timeOf(std::uint64_t cycle) const;
  [[nodiscard]] double robotBaud() const;

  RobotSettings settings_;
  std::int64_t start_us_;
  std::int64_t before_us_;  // now() before the last advance()
  std::int64_t now_us_;
  Chip chip_;
  LineFaults to_robot_;
  LineFaults from_robot_;
};

}  // namespace lab::emulator
