#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/process/child_process.hpp"
#include "common/process/installation.hpp"
#include "common/serial/serial_devices.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/robot_adoption.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

fs::path firmwareOf(const FlashOptions& options) {
  if (!options.firmware.empty()) return options.firmware;
  const fs::path hex = options.programs / "robot_firmware.hex";
  if (!fs::exists(hex)) {
    throw UserError(fmt::format(
        "{} does not exist: {}", hex.string(),
        installation().installHint("robot_firmware.hex",
                                   "it was not built: apt-get install gcc-avr avr-libc, "
                                   "then ./lab flash again")));
  }
  return hex;
}

using Line = std::vector<std::string>;

/// The bootloader can write the program only. With a programmer the fuses are set first
/// (docs/robot.md explains them): one of them preserves the EEPROM, which holds the robot's
/// settings, when the second call erases the chip. In a single call avrdude would erase before it
/// writes the fuses.
std::vector<Line> avrdudeLines(const FlashOptions& options, const fs::path& hex) {
  const std::string program = fmt::format("flash:w:{}:i", hex.string());
  Line line{"avrdude", "-q", "-p", "m328p"};
  const auto with = [&line](const Line& words) {
    Line longer = line;
    longer.insert(longer.end(), words.begin(), words.end());
    return longer;
  };
  if (options.isp.empty()) {
    return {with({"-c", "arduino", "-P", options.port, "-b", std::to_string(options.baud), "-D",
                  "-U", program})};
  }
  line = with({"-c", options.isp});
  if (!options.isp_port.empty()) line = with({"-P", options.isp_port});
  return {with({"-U", "lfuse:w:0xFF:m", "-U", "hfuse:w:0xD7:m", "-U", "efuse:w:0xFD:m"}),
          with({"-U", program})};
}

/// Runs a program on this terminal until it ends. @return its exit code
int execute(const Line& line) {
  try {
    // It goes on if this process is killed: a robot must not be left with half a program.
    ChildProcess program({.arguments = line,
                          .input = ChildSettings::kInherited,
                          .output = ChildSettings::kInherited,
                          .errors = ChildSettings::kInherited,
                          .group = ChildSettings::Group::kShared,
                          .death_signal = 0});
    program.wait();
    return program.code();
  } catch (const std::system_error&) {
    throw UserError(line[0] + ": cannot be started; apt-get install " + line[0]);
  }
}

RobotAdoption::Result meet(AsioLoop& loop, SerialDevices& ports, const FlashOptions& options) {
  std::optional<RobotAdoption::Result> met;
  const RobotAdoption adoption(loop, ports.open(options.port, options.robot_baud), randomUid(),
                               [&](const RobotAdoption::Result& result) {
                                 met = result;
                                 loop.stop();
                               });
  loop.run();
  return *met;
}

}  // namespace

ExitCode flash(const FlashOptions& options) {
  const fs::path hex = firmwareOf(options);
  AsioLoop loop;
  SerialDevices ports(loop, fs::temp_directory_path());  // a folder without simulated lines
  try {
    // Opening the port gives clearer errors than avrdude: who uses it, or that it does not exist.
    (void)ports.open(options.port, options.robot_baud);
  } catch (const SerialError& error) {
    throw UserError(error.what());
  }
  for (const Line& line : avrdudeLines(options, hex)) {
    fmt::print("{}\n", fmt::join(line, " "));
    std::fflush(stdout);
    const int code = execute(line);
    if (code == 0) continue;
    fmt::print(
        "NOT flashed: avrdude failed with exit code {}, for the reason above; the robot may have "
        "no program now\n",
        code);
    return kFailed;
  }
  RobotAdoption::Result met;
  try {
    met = meet(loop, ports, options);
  } catch (const SerialError& error) {
    met.problem = error.what();
  }
  if (!met.ok) {
    fmt::print("flashed, but the robot at {} does not answer as expected: {}\n", options.port,
               printable(met.problem));
    return kFailed;
  }
  fmt::print("flashed: firmware {}.{}, build {:08x}, schema 0x{:04X}\n", met.hello.firmware >> 8,
             met.hello.firmware & 0xFFU, met.hello.build, met.hello.schema);
  fmt::print("uid = {}{}\n", met.hello.uid, met.uid_is_new ? " (new, stored on the robot)" : "");
  return kDone;
}

}  // namespace lab::runner
