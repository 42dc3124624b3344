/// Chips in real time on pseudo terminals, without an arena, to test a host program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/serial/serial_devices.hpp"
#include "sim_svc/emulator/emulated_robot.hpp"

namespace lab::emulator {

struct FreeRunSettings {
  std::filesystem::path elf;
  std::filesystem::path ports;  ///< folder of the lines
  int robots = 1;
  int line_baud = 38400;       ///< of the host's end; a speed other than the robots' garbles bytes
  std::uint16_t light = 512;   ///< counts of both light sensors
  double clock_error_ppm = 0;  ///< of the oscillators
  double bit_error_rate = 0;
  std::uint64_t seed = 1;
  double cable_out_at_s = -1;  ///< below 0: never
  double cable_out_for_s = 1;
  bool reset_on_open = false;      ///< opening the line resets the chip and starts its bootloader
  std::uint32_t cut_in_write = 0;  ///< see Chip::cutPowerInWrite; power returns after a second
  std::filesystem::path
      eeproms{};  ///< folder of <robot>.eeprom, read at the start, written at the end
};

/// Each robot has the uid simulatedUid(id), unless its EEPROM file contains another one.
class FreeRun {
 public:
  /// @throws FirmwareImageError, SerialError
  FreeRun(AsioLoop& loop, const FreeRunSettings& settings);

  /// Writes the EEPROMs to their files. @throws std::runtime_error
  void save() const;

  [[nodiscard]] std::string summary() const;

 private:
  struct Unit {
    std::string name;
    std::unique_ptr<EmulatedRobot> robot;
    std::unique_ptr<SerialPort> port;
    bool connected = false;
    std::int64_t on_again_us = -1;
  };

  void add(int id, std::shared_ptr<const FirmwareImage> program);
  [[nodiscard]] std::filesystem::path eepromFile(const std::string& name) const;
  void tick();
  void serve(Unit& unit, std::int64_t until_us);

  AsioLoop& loop_;
  FreeRunSettings settings_;
  SerialDevices devices_;
  std::vector<Unit> units_;
  std::int64_t start_us_;
  std::int64_t skipped_us_ = 0;  // not simulated because the machine was busy
};

/// Runs until Ctrl-C. @return exit code: 0, or 2 if the robots cannot be set up.
int freeRun(const FreeRunSettings& settings);

}  // namespace lab::emulator
