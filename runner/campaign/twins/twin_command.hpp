/// `lab twin`: compares a run with simulations of the same experiment.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {

inline constexpr int kDefaultTwins = 40;
inline constexpr int kFewestTwins = 10;

struct TwinOptions {
  std::filesystem::path run;                 ///< folder of a run, or a log
  std::optional<std::filesystem::path> out;  ///< default: beside the log
  int count = kDefaultTwins;
  int jobs = 0;  ///< twins at a time; 0: one per core
  bool figures = true;
};

/// Simulates the twins, those that the folder does not have yet, and writes twin.json, twins.csv,
/// twins.html and the section of report.html.
/// @return kDone also if the run deviates; kFailed if twins failed
ExitCode twin(const TwinOptions& options);

void addTwin(CLI::App& app, Chosen& chosen);

}  // namespace lab::runner::campaign
