/// Everything around a run: looking before leaping, its folder, its record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/live/procedure.hpp"
#include "runner/runs/run_directory.hpp"
#include "runner/virtual_time/run_virtual.hpp"

namespace lab::runner {

struct LaunchOptions {
  std::filesystem::path file;      ///< the experiment came from
  std::filesystem::path out;       ///< where run folders are made
  std::filesystem::path programs;  ///< folder of the services' programs
  std::vector<std::string> set;    ///< key=value, for the record
  bool virtual_time = false;
  bool web = false;                     ///< with a page in a browser, in real time
  std::filesystem::path web_address{};  ///< file for its address too, empty: none
};

struct Launched {
  std::filesystem::path directory;
  RunOutcome outcome;
};

/// The path of a program. @throws UserError that says which package has it.
std::filesystem::path requireProgram(const std::string& name, const std::string& package);

/// Runs an experiment, in real or in virtual time, to its end, and leaves its folder with the log.
/// @param show how it stands
/// @param pilot drives the robots instead of their light table; may be empty
/// @throws UserError for what the user can mend, before anything is started
[[nodiscard]] Launched launch(const LaunchOptions& options, Experiment experiment,
                              const ShowProgress& show, const ProcedureFactory& pilot = {});

}  // namespace lab::runner
