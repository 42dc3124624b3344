#include "runner/campaign/twins/twin_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <thread>
#include <utility>

#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/version.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/sweep_progress.hpp"
#include "runner/campaign/twins/twin_page.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/input_path.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFrames = "frames.csv";

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
void prepareTwins(const TwinOrigin& origin, const TwinPlan& twins) {
  refuseLink(twins.folder);
  fs::create_directories(twins.folder);
  refuseCampaignLinks(twins.folder);
  const fs::path frames = twins.folder / kFrames;
  replaceFile(frames, framesText(origin.facts.frames));
  Experiment experiment = origin.twins.experiment;
  experiment.camera.frames = fs::relative(frames, origin.log).string();
  const std::string text = writeExperiment(experiment);
  Request request;
  request.name = experiment.name;
  request.file = (origin.log / files::kExperiment).string();
  request.set = twins.set;
  request.over = twins.over;
  request.random = twins.over.empty() ? 0 : twins.count;
  request.sampling = Sampling::kSobol;
  request.seeds = twins.over.empty() ? twins.count : 1;
  request.seed = experiment.seed;  // the seeds of the rows are hashes of it
  request.keep = Keep::kSummary;
  Plan plan = planCampaign(request, text);
  StoredCampaign campaign{request, runner::utcText(wallClock()), text, std::move(plan.points)};
  try {
    if (isCampaign(twins.folder)) campaign.created = readCampaign(twins.folder).created;
  } catch (const std::exception&) {
    // Damaged; it is written again.
  }
  writeCampaign(twins.folder, campaign, plan.files);
}

}  // namespace

TwinOrigin readTwinOrigin(const fs::path& run) {
  requireFolderOrFile(run, {"the folder of a run or a log", file_kinds::kAny.most_bytes});
  TwinOrigin origin;
  origin.run = run;
  // absolute() first: the folder of "log.lcmlog" must not be empty.
  const fs::path absolute = fs::absolute(run).lexically_normal();
  origin.log = fs::is_directory(run) ? absolute : absolute.parent_path();
  origin.facts = report::readTwinFacts(run, kTwinAnalysis);
  requireComparable(origin.facts, run);
  origin.twins = twinExperimentOf(origin.facts);
  if (origin.facts.version != kVersion) {
    origin.twins.remarks.push_back(fmt::format(
        "The run is of version {}, the twins of {}: what changed between them may show.",
        origin.facts.version.empty() ? "unknown" : origin.facts.version, kVersion));
  }
  return origin;
}

TwinSummaries simulateTwins(const TwinOrigin& origin, const TwinPlan& plan, int jobs) {
  prepareTwins(origin, plan);
  CampaignData data = dataOf(readCampaign(plan.folder));
  const auto lock = FileLock::tryLock(plan.folder / "lock");
  if (!lock) {
    throw UserError(fmt::format("{}: another lab twin simulates the twins of this run; wait",
                                plan.folder.string()));
  }
  data.survey = surveyRows(plan.folder, data.rows);
  std::vector<std::size_t> rows;
  std::error_code error;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const bool done = data.survey.rows[i].kind == RowState::Kind::kDone;
    if (!done || !fs::exists(plan.folder / summaryFile(data.rows[i].identity), error)) {
      if (done) fs::remove(plan.folder / resultFile(data.rows[i].identity), error);
      rows.push_back(i);
    }
  }
  const std::size_t wanted =
      jobs > 0 ? static_cast<std::size_t>(jobs) : std::max(1U, std::thread::hardware_concurrency());
  TwinSummaries twins;
  catchSignals();
  if (!rows.empty()) {
    SweepProgress progress(data, plan.folder, rows, {});
    const EngineEnd end =
        runLocally(data, plan.folder, rows,
                   {.jobs = std::min(wanted, rows.size()), .watch = [&] { progress.update(); }});
    twins.interrupted = end.interrupted;
    twins.reason = end.note;
  }
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RowState& state = data.survey.rows[i];
    if (state.kind == RowState::Kind::kDone) {
      twins.summaries.push_back(
          readFileText(plan.folder / summaryFile(data.rows[i].identity), file_kinds::kText));
      twins.values.push_back(data.points[data.rows[i].point].values);
      continue;
    }
    ++twins.failed;
    if (twins.reason.empty()) twins.reason = state.note;
  }
  return twins;
}

}  // namespace lab::runner::campaign
