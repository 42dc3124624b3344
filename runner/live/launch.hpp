/// Everything around a run: checks before it starts, its folder, its record.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runner/live/procedure.hpp"
#include "runner/live/progress.hpp"
#include "runner/live/run_live.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

/// runVirtual(). Passed in by the programs that link all services.
using RunVirtual = std::function<RunOutcome(const PreparedRun& run, const ShowProgress& show,
                                            const std::function<bool()>& interrupted,
                                            const ProcedureFactory& procedure)>;

struct LaunchOptions {
  std::filesystem::path file;                 ///< of the experiment
  std::filesystem::path out;                  ///< where run folders are made
  std::filesystem::path programs;             ///< folder of the services' programs
  std::vector<std::string> set;               ///< key=value, for the record
  RunVirtual run_virtual{};                   ///< runs in virtual time; empty: in real time
  MakeCameras cameras{};                      ///< for a procedure in real time; empty: none
  bool web = false;                           ///< starts the dashboard; in real time only
  std::filesystem::path web_address{};        ///< a second file for its address, empty: none
  std::optional<UserProgram> user_program{};  ///< takes part in the run
  std::size_t threads = 0;                    ///< of the simulator; 0: one per processor
};

struct Launched {
  std::filesystem::path directory;
  RunOutcome outcome;
};

/// The path of a program. @throws UserError that names the Debian package to install.
std::filesystem::path requireProgram(const std::string& name, const std::string& package);

/// File names, in the folder of programs, of what the experiment needs on this machine: the
/// recorder and its services (in virtual time they are part of the runner), robot_emulator and its
/// firmware.
[[nodiscard]] std::vector<std::string> neededPrograms(const Experiment& experiment,
                                                      bool virtual_time);

/// Why a run of this experiment does not fit into the folder of runs, with the way out; empty if it
/// fits.
/// @param other_folder how the user chooses another one
[[nodiscard]] std::string diskProblem(
    const Experiment& experiment, const std::filesystem::path& folder,
    std::string_view other_folder = "choose another folder with --runs");

/// Runs an experiment to its end, in real or in virtual time, and leaves its folder with the log.
/// @param show called with the state of the run, again and again
/// @param procedure drives the robots instead of their light table; may be empty
/// @throws UserError for what the user can correct, before anything is started
[[nodiscard]] Launched launch(const LaunchOptions& options, Experiment experiment,
                              const ShowProgress& show, const ProcedureFactory& procedure = {});

}  // namespace lab::runner
