#include "sim_svc/emulator/emulated_robot.hpp"

#include <algorithm>
#include <cmath>

namespace lab::emulator {
namespace {

constexpr std::uint64_t kToRobot = 1;
constexpr std::uint64_t kFromRobot = 2;

ChipSettings chipSettings(const RobotSettings& settings) {
  ChipSettings chip;
  chip.line_baud = settings.line_baud / settings.clock_rate;
  chip.seed = settings.seed;
  return chip;
}

}  // namespace

EmulatedRobot::EmulatedRobot(std::shared_ptr<const FirmwareImage> program,
                             const RobotSettings& settings, std::int64_t now_us)
    : settings_(settings),
      start_us_(now_us),
      before_us_(now_us),
      now_us_(now_us),
      chip_(std::move(program), chipSettings(settings)),
      to_robot_(settings.line, kToRobot),
      from_robot_(settings.line, kFromRobot) {
  chip_.loadEeprom(settings.eeprom);
  if (settings_.boot_us <= now_us) {
    chip_.switchOn();
  }
}

std::uint64_t EmulatedRobot::cycleAt(std::int64_t at_us) const {
  return static_cast<std::uint64_t>(
      std::llround(static_cast<double>(at_us - start_us_) * 1e-6 * kChipHz * settings_.clock_rate));
}

/// The time of a cycle, limited to the last advance() because of rounding to microseconds.
std::int64_t EmulatedRobot::timeOf(std::uint64_t cycle) const {
  const double elapsed_us = static_cast<double>(cycle) / (kChipHz * 1e-6 * settings_.clock_rate);
  return std::clamp(start_us_ + static_cast<std::int64_t>(elapsed_us), before_us_, now_us_);
}

/// The robot's bits per second on the arena's clock.
double EmulatedRobot::robotBaud() const { return chip_.baud() * settings_.clock_rate; }

void EmulatedRobot::receive(std::span<const std::uint8_t> bytes) {
  const double ratio = robotBaud() > 0 ? settings_.line_baud / robotBaud() : 1;
  for (const std::uint8_t byte : bytes) {
    if (const auto arriving = to_robot_.pass(now_us_, byte, ratio)) {
      chip_.receive(*arriving);
    }
  }
}

void EmulatedRobot::advance(std::int64_t until_us) {
  before_us_ = now_us_;
  if (settings_.boot_us > now_us_ && settings_.boot_us <= until_us) {
    chip_.runTo(cycleAt(settings_.boot_us));
    chip_.switchOn();
  }
  now_us_ = std::max(now_us_, until_us);
  chip_.runTo(cycleAt(now_us_));
}

std::vector<std::uint8_t> EmulatedRobot::takeSent() {
  const double ratio = robotBaud() > 0 ? robotBaud() / settings_.line_baud : 1;
  std::vector<std::uint8_t> bytes;
  for (const SentByte& sent : chip_.takeSent(cycleAt(now_us_))) {
    // A host's serial driver also delivers bytes with a framing error.
    if (const auto byte = from_robot_.pass(timeOf(sent.cycle), sent.value, ratio)) {
      bytes.push_back(byte->value);
    }
  }
  return bytes;
}

std::vector<DutyAt> EmulatedRobot::takeChanges() {
  std::vector<DutyAt> changes;
  for (const DutyChange& change : chip_.takeChanges(cycleAt(now_us_))) {
    changes.push_back({timeOf(change.cycle), change.duty});
  }
  return changes;
}

}  // namespace lab::emulator
