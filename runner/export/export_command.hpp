/// `lab export`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

struct ExportOptions {
  std::filesystem::path input;  ///< folder of a run, or a log
  std::optional<std::filesystem::path>
      out;  ///< folder for the results; not given: beside the input
  bool mcap = false;
  bool hdf5 = false;
  bool csv = false;
  bool trackpy = false;
  bool trex = false;
  bool force = false;                ///< replace existing files
  bool bus = true;                   ///< MCAP: every message of the bus
  bool ros = true;                   ///< MCAP: the gateway's topics
  std::optional<bool> each_robot;    ///< MCAP: the gateway's topics of single robots
  std::string film;                  ///< MCAP: movie or pictures; empty: the one in the run
  std::optional<double> film_start;  ///< [s since time 0] of its first picture
};
ExitCode exportRun(const ExportOptions& options);

void addExport(CLI::App& app, Chosen& chosen);

}  // namespace lab::runner
