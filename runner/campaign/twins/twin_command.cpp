#include "runner/campaign/twins/twin_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "analyzer/report_error.hpp"
#include "analyzer/twin_facts.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/atomic_file.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/sweep_progress.hpp"
#include "runner/campaign/twins/twin_comparison.hpp"
#include "runner/campaign/twins/twin_experiment.hpp"
#include "runner/campaign/twins/twin_page.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTwins = "twins";  ///< the campaign, below the folder of the results
constexpr const char* kFrames = "frames.csv";
constexpr const char* kReport = "report.html";
constexpr std::size_t kListedLooks = 8;

/// How the run is analyzed, and its twins: without fits, which repeat the direct estimates.
const report::AnalyzeOptions kHow{.needs_frames = false, .depth = analysis::Depth::kLive};

/// What decides where things are.
struct TwinPlaces {
  fs::path log;     ///< folder of the log, to which paths in the experiment are relative
  fs::path out;     ///< of the results
  fs::path folder;  ///< of the campaign
};

TwinPlaces placesOf(const TwinOptions& options) {
  std::error_code error;
  const bool folder = fs::is_directory(options.run, error);
  if (!folder && !fs::is_regular_file(options.run, error)) {
    throw UserError(fmt::format("{}: found nothing, expected the folder of a run or a log",
                                options.run.string()));
  }
  TwinPlaces places;
  places.log = fs::absolute(folder ? options.run : options.run.parent_path()).lexically_normal();
  places.out = places.log;
  if (!folder) {
    places.out = fs::absolute(options.run).lexically_normal();
    places.out += "-twins";
  }
  if (options.out) places.out = fs::absolute(*options.out).lexically_normal();
  places.folder = places.out / kTwins;
  return places;
}

/// Refuses runs whose twins would say nothing.
void requireComparable(const report::TwinFacts& facts, const fs::path& run) {
  const auto& robots = facts.experiment.robots;
  if (std::ranges::all_of(robots,
                          [](const RobotSpec& robot) { return robot.body == Body::kReplay; })) {
    throw UserError(fmt::format(
        "{}: all robots of this run are replayed recordings, so that all twins would be the same; "
        "give the run that was recorded",
        run.string()));
  }
  if (programsOfSummary(facts.summary).empty()) {
    throw UserError(fmt::format(
        "{}: no robot ran a program while it was filmed, so there is nothing to compare",
        run.string()));
  }
}

/// Plans the twins and writes their campaign; results that are there stay.
void prepareTwins(const TwinPlaces& places, const TwinExperiment& twins,
                  const report::TwinFacts& facts, int count) {
  fs::create_directories(places.folder);
  const fs::path frames = places.folder / kFrames;
  replaceFile(frames, framesText(facts.frames));
  Experiment experiment = twins.experiment;
  experiment.camera.frames = fs::relative(frames, places.log).string();
  const std::string text = writeExperiment(experiment);
  Request request;
  request.name = experiment.name;
  request.file = (places.log / files::kExperiment).string();
  request.seeds = count;
  request.seed = experiment.seed;  // the seeds of the rows are hashes of it
  request.keep = Keep::kSummary;
  Plan plan = planCampaign(request, text);
  StoredCampaign campaign{request, runner::utcText(wallClock()), text, std::move(plan.points)};
  try {
    if (isCampaign(places.folder)) campaign.created = readCampaign(places.folder).created;
  } catch (const std::exception&) {
    // Damaged; it is written again.
  }
  writeCampaign(places.folder, campaign, plan.files);
}

/// The summaries of the twins, and why some are missing.
struct TwinSummaries {
  std::vector<std::string> summaries;
  std::size_t failed = 0;
  std::string reason;  ///< of the first failure
  bool interrupted = false;
};

TwinSummaries simulate(const TwinPlaces& places, int jobs) {
  CampaignData data = dataOf(readCampaign(places.folder));
  const auto lock = FileLock::tryLock(places.folder / "lock");
  if (!lock) {
    throw UserError(fmt::format("{}: another lab twin simulates the twins of this run; wait",
                                places.folder.string()));
  }
  data.survey = surveyRows(places.folder, data.rows);
  std::vector<std::size_t> rows;
  std::error_code error;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const bool done = data.survey.rows[i].kind == RowState::Kind::kDone;
    if (!done || !fs::exists(places.folder / summaryFile(data.rows[i].identity), error)) {
      if (done) fs::remove(places.folder / resultFile(data.rows[i].identity), error);
      rows.push_back(i);
    }
  }
  const std::size_t wanted =
      jobs > 0 ? static_cast<std::size_t>(jobs) : std::max(1U, std::thread::hardware_concurrency());
  TwinSummaries twins;
  catchSignals();
  if (!rows.empty()) {
    SweepProgress progress(data, places.folder, rows, {});
    const EngineEnd end =
        runLocally(data, places.folder, rows,
                   {.jobs = std::min(wanted, rows.size()), .watch = [&] { progress.update(); }});
    twins.interrupted = end.interrupted;
    twins.reason = end.note;
  }
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RowState& state = data.survey.rows[i];
    if (state.kind == RowState::Kind::kDone) {
      twins.summaries.push_back(
          readFileText(places.folder / summaryFile(data.rows[i].identity), file_kinds::kText));
      continue;
    }
    ++twins.failed;
    if (twins.reason.empty()) twins.reason = state.note;
  }
  return twins;
}

std::vector<report::DrawnFigure> drawCurves(const std::string& run,
                                            const std::vector<std::string>& twins,
                                            const fs::path& scratch) {
  std::vector<report::ScriptedFigure> scripts;
  for (std::size_t program = 0; program < programsOfSummary(run).size(); ++program) {
    for (const char* key : {"msd", "angular_msd"}) {
      report::ScriptedFigure figure = twinCurve(run, twins, program, key);
      if (!figure.script.empty()) scripts.push_back(std::move(figure));
    }
  }
  if (scripts.empty()) return {};
  return report::drawFigureScripts(scripts, scratch);
}

/// Puts the section into the report of the run, if there is one.
void completeReport(const fs::path& out, const TwinReport& report) {
  const fs::path file = out / kReport;
  std::error_code error;
  if (!fs::exists(file, error)) return;
  const std::string page = readFileText(file, file_kinds::kText);
  replaceFile(file, withTwinSection(page, report));
}

void printLooks(const TwinReport& report) {
  fmt::print("{:<44} {:>12} {:>24} {:>6} {:>9}\n", "most unusual", "run", "95 % of twins", "z",
             "p, all");
  for (const PlacedLook* look : mostUnusual(report.comparison, kListedLooks)) {
    const LookTexts texts = textsOf(*look);
    fmt::print("{:<44} {:>12} {:>24} {:>6} {:>9}\n", printable(texts.name), texts.run,
               texts.interval, texts.z, texts.p_all);
  }
}

}  // namespace

ExitCode twin(const TwinOptions& options) {
  const TwinPlaces places = placesOf(options);
  if (options.figures) requireProgram("gnuplot", "gnuplot-nox");
  const report::TwinFacts facts = report::readTwinFacts(options.run, kHow);
  requireComparable(facts, options.run);
  TwinExperiment twins = twinExperimentOf(facts);
  if (facts.version != kVersion) {
    twins.remarks.push_back(fmt::format(
        "The run is of version {}, the twins of {}: what changed between them may show.",
        facts.version.empty() ? "unknown" : facts.version, kVersion));
  }
  prepareTwins(places, twins, facts, options.count);
  fmt::print("run      {}\n", printable(options.run.string()));
  fmt::print("twins    {} of {:.6g} s in {}\n", options.count, facts.duration,
             printable(places.folder.string()));
  std::fflush(stdout);
  const TwinSummaries simulated = simulate(places, options.jobs);
  if (simulated.interrupted) {
    fmt::print("stopped  by the user; what is done stays, and the same command continues\n");
    return kFailed;
  }
  if (simulated.failed > 0) {
    fmt::print("failed   {} of {} twins: {}\n", simulated.failed, options.count,
               printable(simulated.reason));
  }
  if (simulated.summaries.size() < static_cast<std::size_t>(kFewestTwins)) {
    throw UserError(fmt::format("only {} twins have a result, expected at least {}: {}",
                                simulated.summaries.size(), kFewestTwins, simulated.reason));
  }
  const TwinReport report{places.log.filename().string(), thisCode().text,
                          compareWithTwins(looksOf(facts.summary, simulated.summaries)),
                          twins.remarks};
  std::vector<report::DrawnFigure> figures;
  if (options.figures) figures = drawCurves(facts.summary, simulated.summaries, places.folder);
  replaceFile(places.out / "twin.json", twinJson(report));
  replaceFile(places.out / "twins.csv", twinCsv(report));
  replaceFile(places.out / "twins.html", twinHtml(report, figures));
  completeReport(places.out, report);
  for (const std::string& remark : twins.remarks) fmt::print("note     {}\n", printable(remark));
  printLooks(report);
  fmt::print("result   {} {}\n", printable(report.run), printable(verdictOf(report)));
  fmt::print("page     {}\n", printable((places.out / "twins.html").string()));
  return simulated.failed > 0 ? kFailed : kDone;
}

}  // namespace lab::runner::campaign
