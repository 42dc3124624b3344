#include "runner/campaign/run_row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <system_error>

#include "analyzer/run_summary.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/process/version.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/runs/run_directory.hpp"
#include "runner/virtual_time/run_virtual.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

/// As the file of `lab run`, without what differs between two runs of the same row.
std::string provenanceText(const RunTask& task, const RunOutcome& outcome) {
  const nlohmann::ordered_json json{{"experiment_file", task.request->file},
                                    {"set", task.request->set},
                                    {"campaign", task.request->name},
                                    {"identity", task.row->identity.text()},
                                    {"virtual_time", true},
                                    {"version", kVersion},
                                    {"interrupted", outcome.interrupted},
                                    {"faults", outcome.faults}};
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  return json.dump(2, ' ', false, kReplace) + "\n";
}

RunOutcome execute(const PreparedRun& run) {
  RunOutcome outcome = runVirtual(
      run, [](const Progress&) {}, [] { return false; });
  // Without a reason of the controller, the log could not be written.
  if (outcome.closed_early && outcome.ended_because.empty()) {
    const std::string why = outcome.faults.empty() ? "the run ended" : outcome.faults.back();
    if (tellsOfFullDisk(why)) throw DiskFull(why);
    throw std::runtime_error(why);
  }
  return outcome;
}

}  // namespace

bool needsLiveAnalysis(const Experiment& experiment) {
  const auto asks = [](const LightStep& step) { return !step.until.estimate.empty(); };
  return !experiment.stop_when.empty() || std::ranges::any_of(experiment.light.steps, asks) ||
         // Losses are drawn per message and receiver: without the analyzer others would be lost.
         experiment.faults.message_loss > 0;
}

void runRow(const RunTask& task) {
  const bool logs = task.request->keep == Keep::kLogs;
  const ScratchFolder scratch(task.work / task.row->identity.text());
  std::error_code error;
  fs::remove_all(scratch.path(), error);  // of an interrupted run
  fs::create_directories(scratch.path());
  Experiment experiment = experimentOf(*task.point, task.row->seed, task.campaign);
  const bool live = logs || needsLiveAnalysis(experiment);
  PreparedRun run = prepareRun(std::move(experiment), task.campaign, scratch.path(), 0, "--out");
  run.live_analysis = live;
  const RunOutcome outcome = execute(run);

  const report::AnalyzeOptions how{
      .needs_frames = false,
      .depth = task.request->fits ? analysis::Depth::kFull : analysis::Depth::kLive};
  std::string summary;
  if (logs) {
    writeNewFile(run.directory / files::kProvenance, provenanceText(task, outcome));
    static_cast<void>(report::analyzeRun(run.directory, run.directory, how));
    summary = readFileText(run.directory / "summary.json", file_kinds::kText);
  } else {
    summary = report::summaryOfRun(run.directory, how);
  }
  const RunResult result{task.row->identity,   task.code.text, task.row->seed,
                         outcome.closed_early, outcome.faults, columnsOf(summary)};
  storeRun(task.campaign, task.request->keep, {run.directory, summary, result});
}

void storeRun(const fs::path& campaign, Keep keep, const FinishedRun& run) {
  const RunIdentity& identity = run.result.identity;
  if (keep == Keep::kLogs) moveFolder(run.directory, campaign / runFolder(identity));
  if (keep == Keep::kSummary) {
    const fs::path file = campaign / summaryFile(identity);
    std::error_code ignored;
    fs::create_directories(file.parent_path(), ignored);
    replaceFile(file, run.summary);
  }
  replaceFile(campaign / resultFile(identity), resultText(run.result));
  std::error_code ignored;
  fs::remove(campaign / failureFile(identity), ignored);
}

void moveFolder(const fs::path& from, const fs::path& to) {
  std::error_code ignored;
  fs::create_directories(to.parent_path(), ignored);
  fs::remove_all(to, ignored);
  fs::rename(from, to);
}

}  // namespace lab::runner::campaign
