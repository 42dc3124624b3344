/// `lab calibrate twin`: parameters of the simulation of recorded runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/campaign/twins/twin_command.hpp"
#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {

struct CalibrateTwinOptions {
  std::vector<std::filesystem::path> runs;         ///< folders of runs, or logs
  std::vector<std::string> fit;                    ///< KEY=LOW:HIGH of each parameter
  std::optional<std::filesystem::path> held_out;   ///< a run that is compared, but not fitted
  std::filesystem::path out = "twin-calibration";  ///< folder of the results
  int count = 200;                                 ///< twins of each run in each round
  int rounds = 2;                                  ///< the ranges are narrowed after each
  int compared = kDefaultTwins;                    ///< twins at the fitted parameters
  int jobs = 0;                                    ///< twins at a time; 0: one per core
};

/// Simulates twins with drawn parameters, estimates those of the runs (twin_regression.hpp), and
/// compares the held-out run, or else each fitted one, with twins at the result. Writes fitted.toml
/// and fitted.json.
/// @return kDone also if a run deviates; kFailed if it was interrupted
ExitCode calibrateTwin(const CalibrateTwinOptions& options);

/// Adds `twin` to the command `calibrate`.
void addCalibrateTwin(CLI::App& calibrate, Chosen& chosen);

}  // namespace lab::runner::campaign
