/// One run of a campaign, from its point to its result on the disk. The piece that all engines
/// call.
#pragma once

#include <filesystem>
#include <string>

#include "common/experiment/experiment.hpp"
#include "runner/campaign/campaign.hpp"
#include "runner/campaign/run_result.hpp"

namespace lab::runner::campaign {

/// What a row is run with. All of it is in the campaign's folder, so that every engine on every
/// host computes the same bytes.
struct RunTask {
  std::filesystem::path campaign;  ///< folder
  std::filesystem::path work;      ///< folder for the run in flight
  const Request* request = nullptr;
  const Point* point = nullptr;
  const Row* row = nullptr;
  CodeVersion code;
};

/// Whether the run needs the analyzer while it lasts: a condition asks for an estimate.
[[nodiscard]] bool needsLiveAnalysis(const Experiment& experiment);

/// A run that has ended, with what a campaign keeps of it.
struct FinishedRun {
  std::filesystem::path directory;
  std::string summary;  ///< text of summary.json
  RunResult result;
};

/// Writes what is kept into the campaign's folder; the result last. A failure of this run before is
/// forgotten.
/// @throws DiskFull, std::exception
void storeRun(const std::filesystem::path& campaign, Keep keep, const FinishedRun& run);

/// Moves a folder to its place. What was there is replaced.
void moveFolder(const std::filesystem::path& from, const std::filesystem::path& to);

/// Runs the experiment in virtual time in this process, analyzes its log, and writes what the
/// campaign keeps.
/// @throws DiskFull, std::exception: there is no result
void runRow(const RunTask& task);

}  // namespace lab::runner::campaign
