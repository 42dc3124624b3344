#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report_error.hpp"
#include "common/bus/log_file.hpp"
#include "common/camera/run_film.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/files/output_links.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "runner/analyze/analyze_commands.hpp"
#include "runner/command_line/input_path.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/command_line/progress_bar.hpp"
#include "runner/export/hdf5_import.hpp"
#include "runner/export/mcap_export.hpp"
#include "runner/export/mcap_reader.hpp"
#include "runner/film/retrack.hpp"
#include "runner/film/run_clip.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr FileKind kInput{"the folder of a run, a log or a file of poses, MCAP or HDF5",
                          file_kinds::kAny.most_bytes};

/// Marks a folder whose log was made from a film: it may be made again.
constexpr const char* kRetracked = "retracked.txt";

void printHeadline(const report::AnalyzedRun& analyzed) {
  for (const std::string& line : analyzed.headline) fmt::print("{}\n", printable(line));
  fmt::print("report   {}\n", printable(fs::absolute(analyzed.report).lexically_normal().string()));
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

/// A message about a temporary file, with the name of the file that it was made from.
std::string withName(std::string message, const fs::path& made, const fs::path& from) {
  for (std::size_t at = message.find(made.string()); at != std::string::npos;
       at = message.find(made.string(), at + from.string().size())) {
    message.replace(at, made.string().size(), from.string());
  }
  return message;
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
      try {
        printHeadline(report::analyzePoses(csv, out, columnsOf(options),
                                           {options.program, options.set}, how));
      } catch (const report::ReportError& error) {
        throw report::ReportError(withName(error.what(), csv, input));
      }
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

/// A line for every film of a run.
void printFilms(const fs::path& run) {
  for (const fs::path& folder : filmFolders(run)) {
    try {
      const FilmFacts film = readFilmFacts(folder / film_files::kFacts);
      fmt::print("film     {}: {} frames, {} lost, {:.3g} GB, {:.2g} cores{}\n",
                 printable((folder / film_files::kMovie).string()), film.frames, film.lost,
                 static_cast<double>(film.bytes) * 1e-9,
                 film.duration() > 0 ? film.cpu / film.duration() : 0,
                 film.problem.empty() ? "" : "; ends early: " + printable(film.problem));
    } catch (const ExperimentError& error) {
      fmt::print("note     {}\n", printable(error.what()));
    }
  }
}

/// Makes the pictures of the film of a run, if it has one. A report without them is whole.
void drawFilm(const RetrackOptions& run, const fs::path& log, const fs::path& out) {
  if (const std::string problem = makeRunClip(run, log, out); !problem.empty()) {
    fmt::print("note     no pictures of the film: {}\n", printable(problem));
  }
}

/// Makes the log again with the poses that the film gives now, and analyzes that. The results are
/// a folder like that of a run.
ExitCode analyzeFilm(const AnalyzeOptions& options, const report::AnalyzeOptions& how) {
  const fs::path& run = options.input;
  if (!isRunFolder(run)) {
    throw UserError(run.string() +
                    ": --retrack: found no folder of a run, expected one with log.lcmlog, "
                    "experiment.toml and film/film.mkv");
  }
  if (!options.program.empty() || options.scale_cm || options.fps) {
    throw UserError(run.string() +
                    ": found --program, --scale-cm or --fps, which are for files of poses, not "
                    "with --retrack");
  }
  const RetrackOptions again{run, options.calibration, options.set};
  requireFilm(again);
  const fs::path out = options.out.value_or(run / "retracked");
  if (!options.out) refuseLink(out);
  if (fs::exists(out / files::kLog) && !fs::exists(out / kRetracked)) {
    throw UserError(
        fmt::format("{}: is the log of a run, expected a folder for the new poses; "
                    "choose another with --out",
                    (out / files::kLog).string()));
  }
  const ScratchFolder scratch(report::makeFolderIn(out, ".retrack"));
  const fs::path log = scratch.path() / files::kLog;
  RetrackCounts counts;
  {
    LogWriter writer(log);
    ProgressBar progress(filmFramesOf(run));
    counts =
        retrack(again, &writer, [&](const RetrackedFrame& frame) { progress.show(frame.frames); });
  }
  fs::rename(log, out / files::kLog);
  std::string note = retrackText(counts);
  if (!options.calibration.empty()) note += "; with " + options.calibration.string();
  for (const std::string& setting : options.set) note += "; with " + setting;
  removeLink(out / kRetracked);
  std::ofstream(out / kRetracked) << fs::absolute(run).string() << '\n' << note << '\n';
  fmt::print("film     {}\n", printable(note));
  if (!counts.problem.empty()) fmt::print("fault    {}\n", printable(counts.problem));
  report::AnalyzeOptions with_film = how;
  with_film.film = run;
  with_film.film_note = note;
  if (how.figures) drawFilm(again, out / files::kLog, out);
  printHeadline(report::analyzeRun(out / files::kLog, out, with_film));
  return counts.problem.empty() ? kDone : kClosedEarly;
}

}  // namespace

ExitCode analyze(const AnalyzeOptions& options) {
  const fs::path& input = options.input;
  requireFolderOrFile(input, kInput);
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
  if (!options.out && beside != input) refuseLink(beside);
  const report::AnalyzeOptions how{
      .figures = options.figures,
      .depth = options.bootstrap ? analysis::Depth::kFull : analysis::Depth::kLive,
      .stitch = options.stitch,
      .free_times = options.free_times};
  if (options.retrack) return analyzeFilm(options, how);
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
  if (how.figures && isRunFolder(input)) drawFilm({.run = input}, input / files::kLog, out);
  printHeadline(report::analyzeRun(input, out, how));
  return kDone;
}

ExitCode reportOfRun(const fs::path& directory) {
  try {
    drawFilm({.run = directory}, directory / files::kLog, directory);
    printFilms(directory);
    printHeadline(report::analyzeRun(directory, directory, {.needs_frames = false}));
    return kDone;
  } catch (const std::exception& error) {
    std::fflush(stdout);
    fmt::print(stderr, "lab: no report: {}\n", printable(error.what()));
    return kFailed;
  }
}

}  // namespace lab::runner
