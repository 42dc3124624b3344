#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/experiment_file.hpp"
#include "common/lcm_bus.hpp"
#include "common/units.hpp"
#include "common/version.hpp"
#include "report/analyze_run.hpp"
#include "report/report_error.hpp"
#include "runner/commands.hpp"
#include "runner/disk_need.hpp"
#include "runner/doctor.hpp"
#include "runner/lab_registry.hpp"
#include "runner/network.hpp"
#include "runner/progress_line.hpp"
#include "runner/run_live.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

volatile std::sig_atomic_t interrupted = 0;

std::int64_t wallClock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

fs::path requireProgram(const std::string& name, const std::string& package) {
  if (const auto path = findProgram(name)) return *path;
  throw UserError(fmt::format("{} is not installed: sudo apt-get install {}", name, package));
}

void requireDisk(const Experiment& experiment, const fs::path& folder) {
  const std::int64_t need = diskNeed_bytes(experiment);
  const std::int64_t have = freeBytes(folder);
  if (have >= need) return;
  throw UserError(
      fmt::format("too little disk in {}: this run needs about {} MB, {} MB are free; make room, "
                  "choose another "
                  "folder with --out, or shorten duration_s",
                  folder.string(), need / 1'000'000, have / 1'000'000));
}

RunOutcome execute(const RunOptions& options, const PreparedRun& run, const std::string& url,
                   const fs::path& logger) {
  ProgressLine line(run.experiment.duration);
  const ShowProgress show = [&line](const Progress& progress) { line.show(progress); };
  if (!options.virtual_time) {
    return runLive(run, {.url = url, .programs = options.programs, .lcm_logger = logger}, show);
  }
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  return runVirtual(run, show, [] { return interrupted != 0; });
}

/// What differs between two runs of the same file and seed.
void writeProvenance(const RunOptions& options, const PreparedRun& run, const std::string& url,
                     std::int64_t start, const RunOutcome& outcome) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const std::int64_t end = wallClock();
  const nlohmann::ordered_json json{{"experiment_file", fs::absolute(options.file).string()},
                                    {"set", options.set},
                                    {"started", utcText(start)},
                                    {"ended", utcText(end)},
                                    {"wall_s", units::seconds(end - start)},
                                    {"virtual_time", options.virtual_time},
                                    {"host", host},
                                    {"bus", url},
                                    {"version", kVersion},
                                    {"interrupted", outcome.interrupted},
                                    {"faults", outcome.faults}};
  writeNewFile(run.directory / files::kProvenance, json.dump(2) + "\n");
}

void tell(const report::AnalyzedRun& analyzed) {
  for (const std::string& line : analyzed.headline) fmt::print("{}\n", line);
  fmt::print("report   {}\n", fs::absolute(analyzed.report).lexically_normal().string());
}

}  // namespace

ExitCode run(const RunOptions& options) {
  std::vector<std::string> set = options.set;
  if (options.seed) set.push_back("seed=" + std::to_string(*options.seed));
  Experiment experiment = loadExperiment(options.file, set);

  fs::path logger;
  std::string url;
  std::optional<PortLock> port_lock;
  if (options.report) requireProgram("gnuplot", "gnuplot-nox");
  requireDisk(experiment, options.out);
  if (!options.virtual_time) {
    logger = requireProgram("lcm-logger", "liblcm-bin");
    if (const auto problem = multicastProblem()) throw UserError(*problem);
    const bool wanted = experiment.network.port != 0;
    experiment.network.port = choosePort(experiment.network.port);
    port_lock.emplace(experiment.network.port);
    url = lcmUrl(experiment.network.port, experiment.network.ttl);
    // A heartbeat comes once a second; a port that nobody had bound cannot have a speaker for long.
    refuseForeignTraffic(url, wanted ? 1300 : 300);
  }

  const std::int64_t start = wallClock();
  const PreparedRun prepared =
      prepareRun(std::move(experiment), options.file.parent_path(), options.out, start);
  fmt::print("run      {}\n", prepared.directory.string());
  std::optional<Registration> registration;
  if (!options.virtual_time) {
    fmt::print("bus      {}\n", url);
    registration.emplace(RunningLab{prepared.directory.filename().string(), url, getpid(),
                                    fs::absolute(prepared.directory).string()});
  }
  std::fflush(stdout);
  const RunOutcome outcome = execute(options, prepared, url, logger);
  registration.reset();
  // The run is kept whatever happens; a report takes seconds and is not left half-written.
  std::signal(SIGINT, SIG_IGN);
  writeProvenance(options, prepared, url, start, outcome);

  for (const std::string& fault : outcome.faults) fmt::print("marked   {}\n", fault);
  if (options.report) {
    try {
      tell(report::analyzeRun(prepared.directory, prepared.directory, {.needs_frames = false}));
    } catch (const report::ReportError& error) {
      // The run itself is done: its log is kept, and only the report is missing.
      fmt::print(stderr, "lab: no report: {}\n", error.what());
      return outcome.closed_early ? kMarked : kFailed;
    }
  }
  return outcome.closed_early ? kMarked : kDone;
}

ExitCode check(const fs::path& file, const std::vector<std::string>& set) {
  fmt::print("{}", describeExperiment(loadExperiment(file, set)));
  return kDone;
}

ExitCode analyze(const fs::path& run_or_log, const std::optional<fs::path>& out) {
  if (!fs::is_directory(run_or_log) && !fs::is_regular_file(run_or_log)) {
    throw UserError(run_or_log.string() + " is neither the folder of a run nor a log");
  }
  // The results of two logs in one folder must not replace each other.
  const fs::path beside =
      fs::is_directory(run_or_log) ? run_or_log : fs::path(run_or_log.string() + "-report");
  tell(report::analyzeRun(run_or_log, out.value_or(beside)));
  return kDone;
}

}  // namespace lab::runner
