// robot_emulator: the robot's firmware on simulated chips. Because it links libsimavr, this
// executable as a whole is under the GPL-3.0-or-later (LICENSE.md in this folder).
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "common/command_line/parse_arguments.hpp"
#include "sim_svc/emulator/free_run.hpp"
#include "sim_svc/emulator/lockstep.hpp"

namespace {

std::filesystem::path besideThisProgram(const char* name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (error ? std::filesystem::current_path() : program.parent_path()) / name;
}

void addFaults(CLI::App& app, lab::emulator::FreeRunSettings& run) {
  app.add_option("--bit-errors", run.bit_error_rate, "Probability of a wrong bit on the lines")
      ->check(CLI::Range(0.0, 0.5));
  app.add_option("--clock-error", run.clock_error_ppm, "Error of the oscillators in ppm")
      ->check(CLI::Range(-100'000.0, 100'000.0));
  app.add_option("--cable-out", run.cable_out_at_s, "Unplug the cables after this many seconds")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--cable-out-for", run.cable_out_for_s,
                 "Plug the cables in again after this many seconds (1)")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--reset-on-open", run.reset_on_open,
               "Opening a line resets the chip, as DTR does; the bootloader takes 1.33 s");
  app.add_option("--cut-power", run.cut_in_write,
                 "Cut the power for 1 s during this EEPROM write (1: the first)");
  app.add_option("--eeprom", run.eeproms, "Folder that keeps the EEPROMs between runs");
  app.add_option("--seed", run.seed, "Seed of the wrong bits and of RAM at power-on (1)");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs the unmodified firmware of the robots on simulated ATmega328P chips",
               "robot_emulator"};
  lab::emulator::FreeRunSettings run;
  run.elf = besideThisProgram("robot_firmware.elf");
  int socket = -1;
  app.add_option("--elf", run.elf,
                 "The firmware (default: robot_firmware.elf next to this program)");
  const auto arena =
      app.add_option("--arena-socket", socket,
                     "Run in lockstep with sim_svc, which starts this program, on this socket");
  const auto robots = app.add_option("--robots", run.robots, "In real time: number of robots (1)")
                          ->check(CLI::Range(1, 500));
  const auto ports = app.add_option("--ports", run.ports, "In real time: folder for their lines");
  app.add_option("--baud", run.line_baud, "Speed of the host's end (38400)")
      ->check(CLI::Range(300, 1'000'000));
  app.add_option("--light", run.light, "Reading of the light sensors, in counts (512)")
      ->check(CLI::Range(0, 1023));
  addFaults(app, run);
  arena->excludes(ports)->excludes(robots);
  app.callback([&] {
    if (socket < 0 && run.ports.empty()) throw CLI::RequiredError("--ports or --arena-socket");
  });
  if (const std::optional<int> code = lab::parseArguments(app, argc, argv)) return *code;
  return socket >= 0 ? lab::emulator::serveArena(socket, run.elf) : lab::emulator::freeRun(run);
}
