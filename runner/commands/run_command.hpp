/// `lab run`, in the programs lab (real time) and lab-run-virtual.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner {

struct RunOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  CommandLineSources sources;          ///< what only the command line may name
  std::optional<std::uint64_t> seed;
  bool virtual_time = false;
  std::size_t threads = 0;  ///< of the simulator; 0: one per processor
  bool report = true;
  std::string with;  ///< a program of the user that takes part, with its arguments; empty: none
  std::optional<bool> web;            ///< the dashboard; not given: see wantsDashboard()
  std::filesystem::path web_address;  ///< file for its address too, empty: none
};
ExitCode run(const RunOptions& options);

/// @param run_virtual needed when options.virtual_time is set
ExitCode run(const RunOptions& options, const RunVirtual& run_virtual);

/// The programs that a run with these options executes on this machine: file
/// names in the folder of programs. `./lab` builds them before it starts the run.
[[nodiscard]] std::vector<std::string> programsOfRun(const RunOptions& options);

/// Adds FILE and the options of `lab run`.
void addRunOptions(CLI::App& command, RunOptions& options);

}  // namespace lab::runner
