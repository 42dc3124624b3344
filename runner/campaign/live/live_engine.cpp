#include "runner/campaign/live/live_engine.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "analyzer/analyze_run.hpp"
#include "analyzer/run_summary.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/text/format.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/live/known_points.hpp"
#include "runner/campaign/live/live_journal.hpp"
#include "runner/campaign/live/live_schedule.hpp"
#include "runner/campaign/live/robot_problems.hpp"
#include "runner/campaign/run_row.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

using What = JournalEntry::What;

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kPauseAfterFailure_us = 300 * kSecond_us;
constexpr std::int64_t kLiveDiskReserve = 500'000'000;  // [bytes]
// In the campaign's folder, because its paths are relative to it.
constexpr const char* kPlaying = "playing.toml";

void appendToJournal(const fs::path& folder, const std::string& line) {
  const fs::path path = folder / names::kJournal;
  const FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  const auto size = static_cast<ssize_t>(line.size());
  if (file.get() < 0 || ::write(file.get(), line.data(), line.size()) != size ||
      ::fsync(file.get()) != 0) {
    const std::string why = std::system_category().message(errno);
    if (errno == ENOSPC || errno == EDQUOT) throw DiskFull(path.string() + ": " + why);
    throw std::runtime_error(path.string() + ": " + why);
  }
}

/// The share of the frames in which each robot was seen.
std::map<std::int32_t, double> seenShares(const fs::path& log,
                                          const std::vector<std::int32_t>& robots) {
  std::map<std::int32_t, double> shares;
  for (const std::int32_t id : robots) shares[id] = 0;
  double frames = 0;
  tracked_frame_t frame;
  readLog(logSeries(log), [&](const Packet& packet) {
    if (packet.channel != channels::kTrackedFrame) return;
    if (!decode(packet.data, frame)) return;
    ++frames;
    for (const tracked_pose_t& pose : frame.robots) {
      if (const auto share = shares.find(pose.robot_id); share != shares.end()) ++share->second;
    }
  });
  for (auto& [id, share] : shares) share = frames > 0 ? share / frames : 0;
  return shares;
}

std::vector<std::int32_t> idsOf(const Experiment& experiment) {
  std::vector<std::int32_t> ids;
  for (const RobotSpec& robot : experiment.robots) ids.push_back(robot.id);
  return ids;
}

/// What a run that was played is worth.
struct Verdict {
  std::string summary;
  std::vector<std::string> faults;
  std::vector<std::string> reasons;  ///< why it is repeated; empty: it counts
  std::map<std::int32_t, RobotProblem> robots;
};

Verdict judge(const fs::path& run, const Request& request,
              const std::vector<std::int32_t>& robots) {
  Verdict verdict;
  const report::AnalyzeOptions how{
      .needs_frames = false,
      .depth = request.fits ? analysis::Depth::kFull : analysis::Depth::kLive};
  try {
    if (request.keep == Keep::kLogs) {
      static_cast<void>(report::analyzeRun(run, run, how));
      verdict.summary = readFileText(run / "summary.json", file_kinds::kText);
    } else {
      verdict.summary = report::summaryOfRun(run, how);
    }
    const auto json = nlohmann::json::parse(verdict.summary);
    verdict.faults = json.at("faults").get<std::vector<std::string>>();
    verdict.reasons = verdict.faults;
    if (!json.at("ended").get<bool>()) verdict.reasons.emplace_back("the run has no end");
    verdict.robots = robotProblems(verdict.summary, seenShares(run / files::kLog, robots));
    for (const auto& [id, problem] : verdict.robots) {
      verdict.reasons.push_back(fmt::format("robot {} {}", id, nameOf(problem)));
    }
  } catch (const DiskFull&) {
    throw;
  } catch (const std::exception& error) {
    if (tellsOfFullDisk(error.what())) throw DiskFull(error.what());
    verdict.reasons.emplace_back(error.what());
  }
  return verdict;
}

/// One call of runLive().
class LiveCampaign {
 public:
  LiveCampaign(CampaignData& data, const fs::path& folder, const std::vector<std::size_t>& rows,
               const LiveMachine& machine)
      : data_(data),
        folder_(folder),
        plan_(data.request.live.value()),
        machine_(machine),
        work_(folder),
        schedule_(plan_, data.rows, rows, data.request.seed) {
    for (const JournalEntry& entry : readJournal(journalText(folder)).entries) {
      schedule_.take(entry);
    }
    for (const std::size_t row : rows) {
      if (schedule_.triesOf(row) >= plan_.tries) tries_before_[row] = schedule_.triesOf(row);
    }
    closeKnownPoints();
  }

  EngineEnd run() {
    EngineEnd end;
    try {
      while (const auto row = schedule_.next()) {
        if (mustEnd(*row, end)) return end;
        if (!prepareArena()) continue;  // interrupted
        playRow(*row);
        if (machine_.watch) machine_.watch();
      }
      end.known = data_.survey.count(RowState::Kind::kFailed) == 0;
    } catch (const DiskFull& error) {
      end.disk_full = true;
      end.note = error.what();
    }
    return end;
  }

 private:
  [[nodiscard]] bool mustEnd(std::size_t row, EngineEnd& end) const {
    if (machine_.interrupted()) {
      end.interrupted = true;
      end.note = "ended by the user";
    } else if (freeBytes(folder_) < kLiveDiskReserve) {
      end.disk_full = true;
      end.note = fmt::format("less than {} MB are free in {}", kLiveDiskReserve / 1'000'000,
                             folder_.string());
    } else if (plan_.until_us != 0 && machine_.now() + timeOf(row) > plan_.until_us) {
      end.note = "the next run would end after the time of --until";
    } else if (experimentOfRow(row).robots.empty()) {
      end.note = "all robots are left out; --take-back lets them take part again";
    }
    return !end.note.empty();
  }

  /// What a run needs, with its rest [us].
  [[nodiscard]] std::int64_t timeOf(std::size_t row) const {
    const double seconds = data_.points[data_.rows[row].point].duration + plan_.rest_s;
    return static_cast<std::int64_t>(seconds * 1e6);
  }

  [[nodiscard]] Experiment experimentOfRow(std::size_t row) const {
    Experiment experiment =
        experimentOf(data_.points[data_.rows[row].point], data_.rows[row].seed, folder_);
    std::erase_if(experiment.robots,
                  [&](const RobotSpec& robot) { return schedule_.leftOut().contains(robot.id); });
    return experiment;
  }

  void note(JournalEntry entry) {
    entry.end_us = std::max(entry.begin_us + 1, machine_.now());
    appendToJournal(folder_, journalLine(entry));
    schedule_.take(entry);
  }

  JournalEntry begin(What what) {
    JournalEntry entry;
    entry.what = what;
    entry.begin_us = machine_.now();
    return entry;
  }

  /// @return false if the user interrupts
  bool prepareArena() {
    if (!plan_.clear.empty()) {
      const JournalEntry entry = begin(What::kClear);
      appendToJournal(folder_, journalLine(entry));
      const ScratchFolder scratch(work_.path() / "clear");
      fs::create_directories(scratch.path());
      const PlayedRun played = machine_.play(plan_.clear, scratch.path());
      if (machine_.interrupted()) return false;
      note(entry);
      if (!played.failure.empty()) machine_.say("clear    " + played.failure);
    }
    return pause(What::kRest, static_cast<std::int64_t>(plan_.rest_s * 1e6));
  }

  bool pause(What what, std::int64_t duration_us) {
    if (duration_us <= 0) return !machine_.interrupted();
    const JournalEntry entry = begin(what);
    machine_.wait(entry.begin_us + duration_us);
    if (machine_.interrupted()) return false;
    note(entry);
    return true;
  }

  void playRow(std::size_t row) {
    const RunIdentity& identity = data_.rows[row].identity;
    const Experiment experiment = experimentOfRow(row);
    replaceFile(folder_ / kPlaying, writeExperiment(experiment));
    JournalEntry entry = begin(What::kRun);
    entry.row = row;
    entry.identity = identity.text();
    for (const std::int32_t id : idsOf(experiment)) entry.robots[id] = "";
    appendToJournal(folder_, journalLine(entry));

    const ScratchFolder scratch(work_.path() / identity.text());
    std::error_code ignored;
    fs::remove_all(scratch.path(), ignored);
    fs::create_directories(scratch.path());
    const PlayedRun played = machine_.play(folder_ / kPlaying, scratch.path());
    if (machine_.interrupted()) return;  // the entry keeps no end: the run is lost
    Verdict verdict;
    if (played.run.empty()) {
      verdict.reasons = {played.failure};
    } else {
      verdict = judge(played.run, data_.request, idsOf(experiment));
    }
    for (const auto& [id, problem] : verdict.robots) entry.robots[id] = nameOf(problem);
    entry.reasons = verdict.reasons;
    entry.kept = verdict.reasons.empty();
    if (entry.kept) {
      keep(row, played.run, verdict, entry);
    } else if (!played.run.empty()) {
      const std::int64_t number = schedule_.triesOf(row) + 1;
      moveFolder(played.run,
                 folder_ / names::kMarked / fmt::format("{}-{}", identity.text(), number));
    }
    const auto left_out = schedule_.leftOut();
    note(entry);
    tell(row, entry, left_out);
    if (!entry.kept) repeatOrGiveUp(row, entry);
    data_.survey.rows[row] = readRow(folder_, identity);
    if (entry.kept) closeKnownPoints();
    if (played.run.empty()) static_cast<void>(pause(What::kWait, kPauseAfterFailure_us));
  }

  void keep(std::size_t row, const fs::path& run, const Verdict& verdict,
            const JournalEntry& entry) {
    RunResult result{data_.rows[row].identity, data_.code.text,
                     data_.rows[row].seed,     false,
                     verdict.faults,           columnsOf(verdict.summary)};
    result.columns.emplace_back("live.began", utcText(entry.begin_us));
    result.columns.emplace_back("live.robots", static_cast<double>(entry.robots.size()));
    result.columns.emplace_back("live.tries", static_cast<double>(schedule_.triesOf(row) + 1));
    storeRun(folder_, data_.request.keep, {run, verdict.summary, std::move(result)});
  }

  void tell(std::size_t row, const JournalEntry& entry,
            const std::map<std::int32_t, std::string>& left_out_before) {
    const std::string values =
        fmt::format("{}", fmt::join(data_.points[data_.rows[row].point].values, ", "));
    machine_.say(entry.kept ? fmt::format("run      row {} ({}) counts", row, values)
                            : fmt::format("marked   row {} ({}): {}", row, values,
                                          fmt::join(entry.reasons, "; ")));
    for (const auto& [id, problem] : schedule_.leftOut()) {
      if (left_out_before.contains(id)) continue;
      machine_.say(fmt::format("robot    {} is left out from now on: it {} in {} runs in a row", id,
                               problem, plan_.strikes));
    }
  }

  void repeatOrGiveUp(std::size_t row, const JournalEntry& entry) {
    const auto before = tries_before_.find(row);
    const std::int64_t tries =
        schedule_.triesOf(row) - (before == tries_before_.end() ? 0 : before->second);
    if (tries < plan_.tries) return;
    schedule_.giveUp(row);
    replaceFile(
        folder_ / failureFile(data_.rows[row].identity),
        fmt::format("marked in {} runs, at last: {}\n", tries, fmt::join(entry.reasons, "; ")));
  }

  /// Ends the runs of points whose quantities are known as well as --known asks.
  void closeKnownPoints() {
    if (plan_.known.empty()) return;
    for (const std::size_t point : knownPoints(poolCampaign(data_), plan_.known)) {
      schedule_.closePoint(point);
    }
  }

  CampaignData& data_;
  const fs::path& folder_;
  const LivePlan& plan_;
  const LiveMachine& machine_;
  WorkFolder work_;
  LiveSchedule schedule_;
  /// of rows that were given up before and are tried again
  std::map<std::size_t, std::int64_t> tries_before_;
};

}  // namespace

EngineEnd runLive(CampaignData& data, const fs::path& folder, const std::vector<std::size_t>& rows,
                  const LiveMachine& machine) {
  return LiveCampaign(data, folder, rows, machine).run();
}

void takeBackRobots(const fs::path& folder, std::int64_t now_us) {
  JournalEntry entry;
  entry.what = What::kTakeBack;
  entry.begin_us = now_us;
  entry.end_us = now_us;
  appendToJournal(folder, journalLine(entry));
}

std::string journalText(const fs::path& folder) {
  const fs::path path = folder / names::kJournal;
  if (!fs::exists(path)) return {};
  return readFileText(path, file_kinds::kText);
}

}  // namespace lab::runner::campaign
