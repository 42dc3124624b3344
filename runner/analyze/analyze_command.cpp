#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "analyzer/analyze_run.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "runner/analyze/analyze_commands.hpp"
#include "runner/export/hdf5_import.hpp"
#include "runner/export/mcap_export.hpp"
#include "runner/export/mcap_reader.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

void printHeadline(const report::AnalyzedRun& analyzed) {
  for (const std::string& line : analyzed.headline) fmt::print("{}\n", printable(line));
  fmt::print("report   {}\n", fs::absolute(analyzed.report).lexically_normal().string());
}

bool isPoseFile(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (fs::is_directory(path)) {
    return !fs::exists(path / files::kLog) && !report::trexFiles(path).empty();
  }
  return fs::is_regular_file(path) && (ending == ".csv" || ending == ".CSV" || ending == ".tsv");
}

bool isOpenFormat(const fs::path& path) { return mcap::isMcap(path) || isHdf5(path); }

report::PoseFileOptions columnsOf(const AnalyzeOptions& options) {
  report::PoseFileOptions columns;
  if (options.scale_cm) columns.scale = *options.scale_cm * units::kCentimetre;
  columns.fps = options.fps;
  return columns;
}

/// Makes the log again from a file of `lab export`, or a file of poses from a table in HDF5, and
/// analyzes that.
ExitCode analyzeOpenFormat(const fs::path& input, const fs::path& out,
                           const AnalyzeOptions& options, const report::AnalyzeOptions& how) {
  const ScratchFolder scratch(report::makeFolderIn(out, ".import"));
  const fs::path log = scratch.path() / files::kLog;
  if (isHdf5(input)) {
    const fs::path csv = scratch.path() / (input.stem().string() + ".csv");
    if (importHdf5(input, log, csv) == Hdf5Content::kPoses) {
      printHeadline(
          report::analyzePoses(csv, out, columnsOf(options), {options.program, options.set}, how));
      return kDone;
    }
  } else if (writeLogOfMcap(input, log) == 0) {
    throw UserError(fmt::format(
        "{}: found no topic /bus/..., expected the messages of a run's bus, as lab export --mcap "
        "writes them",
        input.string()));
  }
  printHeadline(report::analyzeRun(log, out, how));
  return kDone;
}

}  // namespace

ExitCode analyze(const AnalyzeOptions& options) {
  const fs::path& input = options.input;
  if (!fs::is_directory(input) && !fs::is_regular_file(input)) {
    throw UserError(input.string() +
                    " is neither the folder of a run nor a log nor a file of poses, MCAP or HDF5");
  }
  // Each log has its own folder of results, so that two logs in one folder do not share them.
  const bool poses = isPoseFile(input);
  fs::path beside = input;
  if (poses || isOpenFormat(input)) {
    beside.replace_extension();
    beside += "-report";
  } else if (!fs::is_directory(input)) {
    beside += "-report";
  }
  const fs::path out = options.out.value_or(beside);
  const report::AnalyzeOptions how{
      .figures = options.figures,
      .depth = options.bootstrap ? analysis::Depth::kFull : analysis::Depth::kLive,
      .stitch = options.stitch};
  if (poses) {
    printHeadline(
        report::analyzePoses(input, out, columnsOf(options), {options.program, options.set}, how));
    return kDone;
  }
  if (isOpenFormat(input)) return analyzeOpenFormat(input, out, options, how);
  if (!options.program.empty() || !options.set.empty() || options.scale_cm || options.fps) {
    throw UserError(
        input.string() +
        ": found no file of poses (.csv); --program, --set, --scale-cm and --fps are for "
        "these, a log knows what its robots ran");
  }
  printHeadline(report::analyzeRun(input, out, how));
  return kDone;
}

ExitCode reportOfRun(const fs::path& directory) {
  try {
    printHeadline(report::analyzeRun(directory, directory, {.needs_frames = false}));
    return kDone;
  } catch (const std::exception& error) {
    std::fflush(stdout);
    fmt::print(stderr, "lab: no report: {}\n", printable(error.what()));
    return kFailed;
  }
}

}  // namespace lab::runner
