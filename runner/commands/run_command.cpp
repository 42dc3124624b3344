#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <optional>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/analyze_run.hpp"
#include "analyzer/laws.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_describe.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/math/units.hpp"
#include "runner/commands/commands.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/live/launch.hpp"
#include "runner/live/progress_line.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

void tell(const report::AnalyzedRun& analyzed) {
  for (const std::string& line : analyzed.headline) fmt::print("{}\n", line);
  fmt::print("report   {}\n", fs::absolute(analyzed.report).lexically_normal().string());
}

bool isPoseFile(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (fs::is_directory(path)) {
    return !fs::exists(path / files::kLog) && !report::trexFiles(path).empty();
  }
  return fs::is_regular_file(path) && (ending == ".csv" || ending == ".CSV" || ending == ".tsv");
}

}  // namespace

ExitCode run(const RunOptions& options) {
  const bool web = wantsDashboard(options.web, options.virtual_time, std::getenv("CI"));
  if (!web && !options.web_address.empty()) {
    throw UserError("--web-address-file " + options.web_address.string() +
                    ": this run has no page in a browser; add --web (not with --virtual-time), or "
                    "leave it out");
  }
  std::vector<std::string> set = options.set;
  if (options.seed) set.push_back("seed=" + std::to_string(*options.seed));
  Experiment experiment = loadExperiment(options.file, set);
  if (options.report) requireProgram("gnuplot", "gnuplot-nox");
  if (options.virtual_time && experiment.gateway.ros) {
    fmt::print(stderr, "lab: ROS 2 sees nothing of a run in virtual time (docs/ros2.md)\n");
  }
  const double duration = experiment.duration;
  double elapsed = 0;
  std::optional<ProgressLine> line(std::in_place, duration);
  const Launched launched = launch({.file = options.file,
                                    .out = options.out,
                                    .programs = options.programs,
                                    .set = options.set,
                                    .virtual_time = options.virtual_time,
                                    .web = web,
                                    .web_address = options.web_address},
                                   std::move(experiment), [&](const Progress& progress) {
                                     elapsed = progress.elapsed;
                                     line->show(progress);
                                   });

  line.reset();
  const RunOutcome& outcome = launched.outcome;
  if (outcome.interrupted) {
    fmt::print("{} after {:.0f} s of {:.10g} s\n", outcome.ended_because, elapsed, duration);
  }
  for (const std::string& fault : outcome.faults) fmt::print("marked   {}\n", fault);
  if (options.report) {
    try {
      tell(report::analyzeRun(launched.directory, launched.directory, {.needs_frames = false}));
    } catch (const std::exception& error) {
      // The run itself is done: its log is kept, and only the report is missing, be it that it
      // cannot be made or that there is no room for it. What broke in the run is said first: it may
      // be why.
      std::fflush(stdout);
      fmt::print(stderr, "lab: no report: {}\n", error.what());
      return outcome.closed_early ? kMarked : kFailed;
    }
  }
  return outcome.closed_early ? kMarked : kDone;
}

ExitCode check(const fs::path& file, const std::vector<std::string>& set) {
  const Experiment experiment = loadExperiment(file, set);
  if (experiment.camera.tracker == Tracker::kCamera) {
    static_cast<void>(cameraInForce(experiment, file.parent_path()));
  }
  checkProjectorFile(experiment, file.parent_path());
  static_cast<void>(activeLightCalibration(experiment, file.parent_path()));
  checkScenes(experiment, file.parent_path());
  const auto length = [&](const RobotProgram& program) {
    const analysis::ProgramLaw law = analysis::toLaw(program, experiment.hardware.diameter);
    return analysis::ExactLaw(law).persistenceLength();
  };
  fmt::print("{}", describeExperiment(experiment, length));
  return kDone;
}

ExitCode analyze(const AnalyzeOptions& options) {
  const fs::path& input = options.input;
  if (!fs::is_directory(input) && !fs::is_regular_file(input)) {
    throw UserError(input.string() +
                    " is neither the folder of a run nor a log nor a file of poses");
  }
  // The results of two logs in one folder must not replace each other.
  const bool poses = isPoseFile(input);
  fs::path beside = input;
  if (poses) {
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
    report::PoseFileOptions columns;
    if (options.scale_cm) columns.scale = *options.scale_cm * units::kCentimetre;
    columns.fps = options.fps;
    tell(report::analyzePoses(input, out, columns, {options.program, options.set}, how));
    return kDone;
  }
  if (!options.program.empty() || !options.set.empty() || options.scale_cm || options.fps) {
    throw UserError(
        input.string() +
        ": found no file of poses (.csv); --program, --set, --scale-cm and --fps are for "
        "these, a log knows what its robots ran");
  }
  tell(report::analyzeRun(input, out, how));
  return kDone;
}

}  // namespace lab::runner
