#include "sim_svc/emulator/free_run.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <iostream>
#include <iterator>
#include <span>
#include <stdexcept>

#include "common/experiment/experiment.hpp"
#include "robot/firmware/settings.hpp"

namespace lab::emulator {
namespace {

constexpr std::int64_t kSliceUs = 2'000;
constexpr std::int64_t kLargestLagUs = 100'000;
constexpr std::uint64_t kBootloaderCycles = 10'640'000;  // 1.33 s, measured on a stock Pro Mini
constexpr std::int64_t kPowerCutUs = 1'000'000;

std::vector<std::uint8_t> freshEeprom(int id) {
  firmware::Settings settings;
  settings.uid = simulatedUid(id);
  std::vector<std::uint8_t> image(firmware::kStoreSize, 0xFF);
  firmware::encodeStore(settings, image.data());
  return image;
}

LineFaultSettings lineFaults(const FreeRunSettings& settings, int id, std::int64_t start_us) {
  LineFaultSettings faults;
  faults.bit_error_rate = settings.bit_error_rate;
  faults.seed = deriveSeed(settings.seed, id, "line");
  if (settings.cable_out_at_s >= 0) {
    const auto from = start_us + static_cast<std::int64_t>(settings.cable_out_at_s * 1e6);
    faults.outages.push_back(
        {from, from + static_cast<std::int64_t>(settings.cable_out_for_s * 1e6)});
  }
  return faults;
}

}  // namespace

FreeRun::FreeRun(AsioLoop& loop, const FreeRunSettings& settings)
    : loop_(loop), settings_(settings), devices_(loop, settings.ports), start_us_(loop.now()) {
  const auto program = std::make_shared<const FirmwareImage>(settings.elf);
  for (int id = 1; id <= settings.robots; ++id) {
    add(id, program);
  }
  loop.every(kSliceUs, loop.now() + kSliceUs, [this] { tick(); });
}

void FreeRun::add(int id, std::shared_ptr<const FirmwareImage> program) {
  Unit unit;
  unit.name = (id < 10 ? "robot_0" : "robot_") + std::to_string(id);
  RobotSettings robot;
  robot.boot_us = start_us_;
  robot.clock_rate = 1 + settings_.clock_error_ppm * 1e-6;
  robot.line_baud = settings_.line_baud;
  robot.line = lineFaults(settings_, id, start_us_);
  robot.seed = deriveSeed(settings_.seed, id, "ram");
  robot.eeprom = freshEeprom(id);
  if (!settings_.eeproms.empty()) {
    if (std::ifstream file(eepromFile(unit.name), std::ios::binary); file) {
      robot.eeprom.assign(std::istreambuf_iterator<char>(file), {});
    }
  }
  unit.robot = std::make_unique<EmulatedRobot>(std::move(program), robot, start_us_);
  AnalogInputs inputs;
  inputs.light_front = inputs.light_back = settings_.light;
  unit.robot->sense(inputs);
  unit.robot->chip().cutPowerInWrite(settings_.cut_in_write);
  unit.port = devices_.offer(unit.name);
  std::cout << unit.name << ' ' << (settings_.ports / unit.name).string() << '\n';
  units_.push_back(std::move(unit));
}

std::filesystem::path FreeRun::eepromFile(const std::string& name) const {
  return settings_.eeproms / (name + ".eeprom");
}

void FreeRun::save() const {
  if (settings_.eeproms.empty()) {
    return;
  }
  std::filesystem::create_directories(settings_.eeproms);
  for (const Unit& unit : units_) {
    const auto image = unit.robot->chip().eeprom();
    std::ofstream file(eepromFile(unit.name), std::ios::binary);
    std::copy(image.begin(), image.end(), std::ostreambuf_iterator<char>(file));
    if (!file.flush()) {
      throw std::runtime_error(eepromFile(unit.name).string() + ": cannot be written");
    }
  }
}

void FreeRun::tick() {
  const std::int64_t lag = loop_.now() - skipped_us_ - units_.front().robot->now();
  if (lag > kLargestLagUs) {
    skipped_us_ += lag - kSliceUs;
  }
  const std::int64_t until = loop_.now() - skipped_us_;
  for (Unit& unit : units_) {
    serve(unit, until);
  }
}

void FreeRun::serve(Unit& unit, std::int64_t until_us) {
  EmulatedRobot& robot = *unit.robot;
  const bool connected = unit.port->isConnected();
  if (connected && !unit.connected && settings_.reset_on_open) {
    robot.chip().reset(kBootloaderCycles);
  }
  unit.connected = connected;
  std::array<std::uint8_t, 256> bytes{};
  robot.receive(std::span(bytes).first(unit.port->read(bytes)));
  if (robot.chip().power() == ChipPower::kOff && unit.on_again_us < 0) {
    unit.on_again_us = until_us + kPowerCutUs;
  } else if (unit.on_again_us >= 0 && until_us >= unit.on_again_us) {
    unit.on_again_us = -1;
    robot.chip().switchOn();
  }
  robot.advance(until_us);
  const auto sent = robot.takeSent();
  if (!sent.empty()) {
    static_cast<void>(unit.port->write(sent));
  }
  static_cast<void>(robot.takeChanges());
}

std::string FreeRun::summary() const {
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
  std::uint64_t overrun = 0;
  std::uint32_t resets = 0;
  for (const Unit& unit : units_) {
    const ChipCounts& counts = unit.robot->chip().counts();
    received += counts.bytes_received;
    sent += counts.bytes_sent;
    overrun += counts.bytes_overrun;
    resets += counts.resets;
  }
  return std::to_string(received) + " bytes received, " + std::to_string(overrun) + " overrun, " +
         std::to_string(sent) + " sent, " + std::to_string(resets) + " resets, " +
         std::to_string(skipped_us_ / 1000) + " ms skipped";
}

int freeRun(const FreeRunSettings& settings) {
  try {
    AsioLoop loop;
    FreeRun robots(loop, settings);
    std::cout << std::flush;
    loop.onSignals({SIGINT, SIGTERM}, [&loop](int) { loop.stop(); });
    loop.run();
    robots.save();
    std::cout << robots.summary() << '\n';
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "robot_emulator: " << error.what() << '\n';
    return 2;
  }
}

}  // namespace lab::emulator
