/// The analysis behind `lab analyze`, which every run also makes at its end.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"
#include "analyzer/report/poses/pose_run.hpp"

namespace lab::report {

struct AnalyzeOptions {
  /// True: a log without camera frames is an error. False: losses, faults and latencies are
  /// reported.
  bool needs_frames = true;
  bool figures = true;  ///< False: no figures.
  analysis::Depth depth = analysis::Depth::kFull;
  /// Folder of the run whose film is shown, if the log lies elsewhere.
  std::filesystem::path film = {};
  std::string film_note = {};  ///< how its poses were tracked again, for the report
  bool stitch =
      true;  ///< False: reversals are removed, and the track is cut there instead of joined.
  /// Durations of the programs (epsilon, tau_t) that the fits free.
  std::vector<std::string> free_times = {};
};

/// The files and texts of a finished analysis.
struct AnalyzedRun {
  std::filesystem::path report;              ///< report.html
  std::vector<std::filesystem::path> files;  ///< everything written
  std::vector<std::string> headline;  ///< lines for the terminal: one per program, then remarks
};

/// A new folder below the folder of the results, on the same file system, for unfinished files.
/// @throws ReportError if it cannot be made
[[nodiscard]] std::filesystem::path makeFolderIn(const std::filesystem::path& out,
                                                 std::string_view name);

/// Reads RUN (a run's folder) or LOG (a log file) and writes summary.json, report.html,
/// trajectories.csv and the figures, each completely or not at all, with the same bytes every time.
/// Existing files of the same names are replaced.
/// @param out_directory output folder; empty: RUN, or the folder of LOG. Created if it does not
/// exist.
/// @throws ReportError if the log, gnuplot or the folder cannot be used; then nothing was written.
[[nodiscard]] AnalyzedRun analyzeRun(const std::filesystem::path& run_or_log,
                                     const std::filesystem::path& out_directory = {},
                                     const AnalyzeOptions& options = {});

/// The same for a file of poses (docs/track.md), which has neither light nor robot status.
/// @param out_directory output folder, created if it does not exist.
/// @throws ReportError as above, and if the file cannot be parsed; ExperimentError if the program
/// is invalid.
[[nodiscard]] AnalyzedRun analyzePoses(const std::filesystem::path& file,
                                       const std::filesystem::path& out_directory,
                                       const PoseFileOptions& poses, const PoseProgram& program,
                                       const AnalyzeOptions& options = {});

}  // namespace lab::report
