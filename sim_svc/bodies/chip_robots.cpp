#include "sim_svc/bodies/chip_robots.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>

#include "common/process/installation.hpp"

namespace lab::sim {
namespace {

template <class T>
void append(std::vector<std::uint8_t>& packet, const T& item) {
  packet.resize(packet.size() + sizeof item);
  std::memcpy(packet.data() + packet.size() - sizeof item, &item, sizeof item);
}

/// Reads an answer from front to back.
class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  template <class T>
  T take() {
    T item;
    std::memcpy(&item, takeBytes(sizeof item).data(), sizeof item);
    return item;
  }

  std::span<const std::uint8_t> takeBytes(std::size_t size) {
    if (size > left_.size()) throw std::runtime_error("its answer is truncated");
    const auto bytes = left_.first(size);
    left_ = left_.subspan(size);
    return bytes;
  }

  [[nodiscard]] std::string rest() const { return {left_.begin(), left_.end()}; }
  [[nodiscard]] bool empty() const { return left_.empty(); }

 private:
  std::span<const std::uint8_t> left_;
};

void append(std::vector<std::uint8_t>& packet, chip::Packet kind, std::int64_t until_us,
            std::size_t robots) {
  chip::Header header;
  header.packet = kind;
  header.until_us = until_us;
  header.robots = static_cast<std::uint32_t>(robots);
  append(packet, header);
}

/// Reads the header of an answer and checks its kind.
void expect(Parser& answer, chip::Packet kind, std::size_t robots) {
  const auto header = answer.take<chip::Header>();
  if (header.version != chip::kLinkVersion) {
    throw std::runtime_error("it uses version " + std::to_string(header.version) +
                             " of the link, expected " + std::to_string(chip::kLinkVersion) +
                             "; build both programs again");
  }
  if (header.packet == chip::Packet::kFailed) throw std::runtime_error(answer.rest());
  if (header.packet != kind || header.robots != robots) {
    throw std::runtime_error("its answer does not match the request");
  }
}

}  // namespace

ChipRobots::ChipRobots(const World& world, std::vector<ChipRobotSetup> setups,
                       const std::filesystem::path& programs, Report report)
    : program_(programs / "robot_emulator"), report_(std::move(report)) {
  for (ChipRobotSetup& setup : setups) {
    Chip chip;
    chip.id = world.id(setup.body);
    chip.clock_rate = world.clock(setup.body).rate();
    chip.boot_us = std::llround(1e6 * world.bootTime(setup.body));
    chip.setup = std::move(setup);
    chips_.push_back(std::move(chip));
  }
  const std::string robot =
      chips_.empty() ? "robots" : "robot " + std::to_string(chips_.front().id);
  for (const char* file : {"robot_emulator", "robot_firmware.elf"}) {
    if (std::filesystem::exists(programs / file)) continue;
    throw std::runtime_error(
        robot + " has body = \"firmware\", which needs " + (programs / file).string() +
        ": not there; " +
        installation().installHint(file,
                                   "install gcc-avr, avr-libc and libsimavr-dev "
                                   "and build again") +
        ", or use body = \"wire\"");
  }
  try {
    start(world.timeUs());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(program_.string() + " does not start: " + error.what());
  }
}

void ChipRobots::start(std::int64_t now_us) {
  emulator_ = std::make_unique<EmulatorProcess>(program_);
  packet_.clear();
  append(packet_, chip::Packet::kSetup, now_us, chips_.size());
  for (const Chip& chip : chips_) {
    chip::ChipSetup setup;
    setup.id = chip.id;
    setup.eeprom_size = static_cast<std::uint32_t>(chip.setup.eeprom.size());
    setup.boot_us = std::max(chip.boot_us, now_us);
    setup.clock_rate = chip.clock_rate;
    append(packet_, setup);
    packet_.insert(packet_.end(), chip.setup.eeprom.begin(), chip.setup.eeprom.end());
  }
  Parser answer(emulator_->exchange(packet_, kStartTimeout_ms));
  expect(answer, chip::Packet::kReady, chips_.size());
}

void ChipRobots::receive(std::size_t k, std::span<const std::uint8_t> bytes) {
  // Limits the size of a STEP packet, however much is written to a line.
  constexpr std::size_t kMost = 1024;
  std::vector<std::uint8_t>& received = chips_[k].received;
  const auto taken = bytes.first(std::min(bytes.size(), kMost - received.size()));
  received.insert(received.end(), taken.begin(), taken.end());
}

void ChipRobots::advance(World& world, std::int64_t until_us) {
  for (Chip& chip : chips_) chip.sent.clear();
  try {
    if (!emulator_ && failures_ < kMostFailures && world.timeUs() >= restart_us_) {
      start(world.timeUs());
    }
    if (emulator_) step(world, until_us);
  } catch (const std::runtime_error& error) {
    fail(world, error.what());
  }
  for (Chip& chip : chips_) chip.received.clear();
}

void ChipRobots::step(World& world, std::int64_t until_us) {
  packet_.clear();
  append(packet_, chip::Packet::kStep, until_us, chips_.size());
  for (const Chip& chip : chips_) {
    const dynamics::Sensors sensors = world.measure(chip.setup.body);
    chip::ChipInput input;
    std::copy(std::begin(sensors.ir), std::end(sensors.ir), std::begin(input.ir));
    input.light_front = sensors.light_front;
    input.light_back = sensors.light_back;
    input.rx_size = static_cast<std::uint32_t>(chip.received.size());
    append(packet_, input);
    packet_.insert(packet_.end(), chip.received.begin(), chip.received.end());
  }
  applyAnswer(world, until_us, emulator_->exchange(packet_, kStepTimeout_ms));
}

void ChipRobots::applyAnswer(World& world, std::int64_t until_us,
                             std::span<const std::uint8_t> bytes) {
  Parser answer(bytes);
  expect(answer, chip::Packet::kStepped, chips_.size());
  for (Chip& chip : chips_) {
    const auto output = answer.take<chip::ChipOutput>();
    std::int64_t earliest = world.timeUs();
    for (std::uint32_t change = 0; change < output.changes; ++change) {
      const auto motors = answer.take<chip::WheelChange>();
      if (motors.at_us < earliest || motors.at_us > until_us) {
        throw std::runtime_error("it sets motors at a time outside its step");
      }
      earliest = motors.at_us;
      world.setMotors(chip.setup.body, {motors.at_us, motors.left, motors.right});
    }
    const auto sent = answer.takeBytes(output.tx_size);
    chip.sent.assign(sent.begin(), sent.end());
    const bool crashed = output.state == chip::ChipState::kCrashed;
    if (crashed && !chip.crashed) {
      report_("robot " + std::to_string(chip.id) +
              ": its chip has crashed (it sleeps with interrupts off or left its program)");
    }
    chip.crashed = crashed;
  }
  if (!answer.empty()) throw std::runtime_error("its answer is too long");
}

void ChipRobots::fail(World& world, const std::string& why) {
  emulator_.reset();
  const std::int64_t now_us = world.timeUs();
  if (failures_ > 0 && now_us - failed_us_ > kFailureMemory_us) failures_ = 0;
  ++failures_;
  failed_us_ = now_us;
  restart_us_ = now_us + kRestartDelay_us;
  for (Chip& chip : chips_) {
    chip.sent.clear();
    chip.crashed = false;
    world.setMotors(chip.setup.body, {now_us, 0, 0});
  }
  report_(
      "robot_emulator: " + why + "; its robots stand and " +
      (failures_ < kMostFailures ? "are switched on again in 1 s" : "stay off: restart the lab"));
}

}  // namespace lab::sim
