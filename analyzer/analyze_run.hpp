/// What `lab analyze` does, and every run at its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/report/poses/pose_file.hpp"
#include "analyzer/report/poses/pose_run.hpp"

namespace lab::report {

struct AnalyzeOptions {
  /// A log without camera frames is an error, unless what else it tells shall be reported: losses,
  /// faults, latencies.
  bool needs_frames = true;
  bool figures = true;  ///< False: numbers only.
  analysis::Depth depth = analysis::Depth::kFull;
  bool stitch = true;  ///< False: reversals are removed and cut, and nothing is joined.
};

/// What came of it.
struct AnalyzedRun {
  std::filesystem::path report;              ///< report.html
  std::vector<std::filesystem::path> files;  ///< everything written
  std::vector<std::string> headline;         ///< for the terminal, a line a program and more
};

/// Reads RUN (a run's folder) or LOG (a log file) and writes summary.json, report.html,
/// trajectories.csv and the figures, each whole or not at all, and to the same bytes every time.
/// Files of the same names are replaced.
/// @param out_directory where to; empty: RUN, or the folder of LOG. It is made where it is missing.
/// @throws ReportError saying what is wrong with the log, gnuplot or the folder; then nothing was
/// written.
[[nodiscard]] AnalyzedRun analyzeRun(const std::filesystem::path& run_or_log,
                                     const std::filesystem::path& out_directory = {},
                                     const AnalyzeOptions& options = {});

/// The same of a file of poses (docs/track.md), without a light and without what robots report.
/// @param out_directory where to; it is made where it is missing.
/// @throws ReportError as above and where the file cannot be understood, ExperimentError where the
/// program is not a valid one.
[[nodiscard]] AnalyzedRun analyzePoses(const std::filesystem::path& file,
                                       const std::filesystem::path& out_directory,
                                       const PoseFileOptions& poses, const PoseProgram& program,
                                       const AnalyzeOptions& options = {});

}  // namespace lab::report
