/// Robots that run the firmware binary on simulated chips, in the process robot_emulator.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim_svc/bodies/body_driver.hpp"
#include "sim_svc/bodies/chip_link.hpp"
#include "sim_svc/bodies/emulator_process.hpp"

namespace lab::sim {

/// Initial state of one robot on a chip.
struct ChipRobotSetup {
  std::size_t body = 0;              ///< The world's robot that it drives.
  std::vector<std::uint8_t> eeprom;  ///< From address 0; the rest is blank.
};

/// The chips of robot_emulator in lockstep with the world: they run exactly as far as advance()
/// requests, and the world does not move meanwhile.
///
/// If the emulator ends, hangs or sends an invalid answer, the robots stand and `report` is called
/// once. One second of world time later the chips are switched on again with their initial EEPROM.
/// After three failures in a row they stay off.
class ChipRobots final : public BodyDriver {
 public:
  using Report = std::function<void(const std::string&)>;

  static constexpr int kStepTimeout_ms = 2000;    ///< For one step; real time.
  static constexpr int kStartTimeout_ms = 10000;  ///< To load the firmware; real time.
  static constexpr std::int64_t kRestartDelay_us = 1'000'000;
  static constexpr int kMostFailures = 3;
  /// Failures are forgotten after this time without another one.
  static constexpr std::int64_t kFailureMemory_us = 30'000'000;

  /// @param programs folder with robot_emulator and robot_firmware.elf
  /// @throws std::runtime_error (one line) if something is missing or the emulator does not start
  ChipRobots(const World& world, std::vector<ChipRobotSetup> setups,
             const std::filesystem::path& programs, Report report);

  [[nodiscard]] std::size_t size() const override { return chips_.size(); }
  [[nodiscard]] std::size_t body(std::size_t k) const override { return chips_[k].setup.body; }
  void receive(std::size_t k, std::span<const std::uint8_t> bytes) override;
  void advance(World& world, std::int64_t until_us) override;
  [[nodiscard]] std::span<const std::uint8_t> sent(std::size_t k) const override {
    return chips_[k].sent;
  }
  [[nodiscard]] std::int64_t program(std::size_t) const override { return kUnknown; }

  [[nodiscard]] const EmulatorProcess* emulator() const { return emulator_.get(); }

 private:
  struct Chip {
    ChipRobotSetup setup;
    std::int32_t id = 0;
    double clock_rate = 1;
    std::int64_t boot_us = 0;
    std::vector<std::uint8_t> received;
    std::vector<std::uint8_t> sent;
    bool crashed = false;
  };

  void start(std::int64_t now_us);
  void step(World& world, std::int64_t until_us);
  void applyAnswer(World& world, std::int64_t until_us, std::span<const std::uint8_t> answer);
  void fail(World& world, const std::string& why);

  std::filesystem::path program_;
  Report report_;
  std::vector<Chip> chips_;
  std::unique_ptr<EmulatorProcess> emulator_;
  std::vector<std::uint8_t> packet_;
  std::int64_t restart_us_ = 0;
  std::int64_t failed_us_ = 0;
  int failures_ = 0;
};

}  // namespace lab::sim
