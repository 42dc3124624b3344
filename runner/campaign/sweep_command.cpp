#include "runner/campaign/sweep_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/installation.hpp"
#include "common/text/format.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/adaptive/adaptive_engine.hpp"
#include "runner/campaign/adaptive/adaptive_goal.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/campaign_page.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/design.hpp"
#include "runner/campaign/engines/bundles.hpp"
#include "runner/campaign/engines/engine.hpp"
#include "runner/campaign/live/live_engine.hpp"
#include "runner/campaign/live/live_journal.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/sweep_description.hpp"
#include "runner/campaign/sweep_progress.hpp"
#include "runner/campaign/sweep_request.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

using Kind = RowState::Kind;

constexpr std::size_t kManyPoints = 5000;  // their check takes some seconds
constexpr std::size_t kMostTasks = 1000;   // of a job array: the default of Slurm's MaxArraySize

std::string sizeText(std::int64_t bytes) {
  if (bytes < 10'000'000) return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
  if (bytes < 10'000'000'000) return fmt::format("{:.0f} MB", static_cast<double>(bytes) * 1e-6);
  return fmt::format("{:.0f} GB", static_cast<double>(bytes) * 1e-9);
}

/// A folder that must not be taken for a campaign's.
void requireEmptyOrCampaign(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error) || isCampaign(folder)) return;
  if (!fs::is_directory(folder, error)) {
    throw UserError(folder.string() + ": found a file, expected a folder; choose another --out");
  }
  if (!fs::is_empty(folder, error)) {
    throw UserError(folder.string() +
                    ": found a folder that is no campaign, expected none or an empty one; choose "
                    "another --out");
  }
}

/// Where the campaign of a request is, or will be.
fs::path folderFor(const SweepOptions& options, const Request& request) {
  if (options.out) {
    requireEmptyOrCampaign(*options.out);
    return *options.out;
  }
  if (!options.fresh) {
    if (const auto known = findCampaign(options.campaigns, request)) return *known;
  }
  return makeRunDirectory(options.campaigns, request.name, wallClock(), "--out");
}

/// What the numbers of a campaign come from.
std::string originOf(const Request& request) {
  if (!request.live) return "simulated runs";
  return request.live->rehearsal ? "a rehearsal" : "runs of the real lab";
}

/// Measured and simulated numbers must not lie in one folder.
void requireSameOrigin(const fs::path& folder, const Request& before, const Request& request) {
  if (originOf(before) == originOf(request)) return;
  throw UserError(fmt::format("{}: found {}, expected {}: choose another --out", folder.string(),
                              originOf(before), originOf(request)));
}

/// The campaign that is in a folder already; says so if it is damaged.
std::optional<StoredCampaign> storedBefore(const fs::path& folder) {
  if (!isCampaign(folder)) return {};
  try {
    return readCampaign(folder);
  } catch (const std::exception& error) {
    fmt::print("damaged  {}; written again\n", printableLines(error.what()));
    return {};
  }
}

/// The campaign of a command line with an experiment file, planned and written.
fs::path prepare(const SweepOptions& options) {
  const std::string text = readFileText(options.input, file_kinds::kExperiment);
  const Request request = requestOf(options, text);
  if (const std::size_t points = pointsOf(request.design()).size(); points >= kManyPoints) {
    fmt::print(stderr, "checking {} points\n", points);
  }
  Plan plan = planCampaign(request, text);
  if (request.adaptive) static_cast<void>(goalOf(request, plan.points));
  const fs::path folder = folderFor(options, request);
  refuseCampaignLinks(folder);
  StoredCampaign campaign{request, runner::utcText(wallClock()), text, std::move(plan.points)};
  if (const auto before = storedBefore(folder)) {
    requireSameOrigin(folder, before->request, request);
    campaign.created = before->created;
    if (before->experiment_text != text) {
      fmt::print("changed  {} has changed since the campaign began\n",
                 printable(options.input.string()));
    }
  }
  writeCampaign(folder, campaign, plan.files);
  return folder;
}

void refuseRequestOptions(const SweepOptions& options) {
  const bool asked = !options.set.empty() || !options.over.empty() || options.zip ||
                     options.seeds || options.random || !options.sampling.empty() || options.seed ||
                     options.common_seeds || !options.keep.empty() || options.fits || options.out ||
                     options.adaptive || !options.clear.empty() || !options.known.empty();
  if (!asked) return;
  throw UserError(
      options.input.string() +
      " is a campaign, whose campaign.toml says what was asked; to ask for something else: lab "
      "sweep FILE --out " +
      options.input.string() + " ...");
}

std::vector<std::size_t> rowsToRun(const CampaignData& data, const SweepOptions& options) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Kind kind = data.survey.rows[i].kind;
    if (kind == Kind::kDone || (kind == Kind::kFailed && !options.retry) ||
        (kind == Kind::kStale && !options.redo_stale)) {
      continue;
    }
    rows.push_back(i);
  }
  return rows;
}

std::size_t jobsOf(const SweepOptions& options, std::size_t rows) {
  const std::size_t wanted = options.jobs > 0 ? static_cast<std::size_t>(options.jobs)
                                              : std::max(1U, std::thread::hardware_concurrency());
  return std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(1, rows));
}

void requireDisk(const CampaignData& data, const fs::path& folder,
                 const std::vector<std::size_t>& rows, std::size_t jobs) {
  std::vector<Row> chosen;
  for (const std::size_t row : rows) chosen.push_back(data.rows[row]);
  const Cost cost = costOf(data.request, data.points, chosen);
  const std::int64_t need =
      cost.kept_bytes + cost.work_bytes * static_cast<std::int64_t>(jobs) + 100'000'000;
  const std::int64_t have = freeBytes(folder);
  fmt::print("disk     about {} will be kept, and {} are needed meanwhile; {} are free\n",
             sizeText(cost.kept_bytes), sizeText(cost.work_bytes * static_cast<std::int64_t>(jobs)),
             sizeText(have));
  if (have >= need) return;
  throw UserError(fmt::format(
      "too little disk in {}: this campaign needs about {}, {} are free; make room, choose another "
      "folder with --out, or keep less with --keep summary or nothing",
      folder.string(), sizeText(need), sizeText(have)));
}

FileLock lockOf(const fs::path& folder) {
  auto lock = FileLock::tryLock(folder / names::kLock);
  if (lock) return std::move(*lock);
  throw UserError(fmt::format(
      "{}: another lab sweep runs this campaign; wait for its end, or choose another --out",
      folder.string()));
}

/// Runs some rows without tables: the worker of other engines.
ExitCode work(const SweepOptions& options) {
  refuseCampaignLinks(options.input);
  CampaignData data = dataOf(readCampaign(options.input));
  std::vector<std::size_t> rows = parseRowNumbers(options.rows, data.rows.size());
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  refreshRows(data, options.input, rows);
  std::vector<std::size_t> todo;
  for (const std::size_t row : rows) {
    if (data.survey.rows[row].kind != Kind::kDone) todo.push_back(row);
  }
  catchSignals();
  const std::size_t jobs = options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : 1;
  const EngineEnd end = runLocally(data, options.input, todo, {.jobs = jobs});
  if (!end.note.empty()) fmt::print(stderr, "lab: {}\n", printable(end.note));
  if (!options.bundle_file.empty()) {
    writeResultBundle(data, options.input, rows, options.bundle_file);
  }
  bool all = true;
  for (const std::size_t row : rows) {
    const RowState& state = data.survey.rows[row];
    if (state.kind == Kind::kDone) continue;
    all = false;
    fmt::print(stderr, "failed   row {}: {}\n", row, printable(state.note));
  }
  return all ? kDone : kFailed;
}

std::vector<std::string> hostsOf(const SweepOptions& options) {
  std::vector<std::string> hosts;
  std::istringstream words(options.hosts);
  for (std::string host; std::getline(words, host, ',');) {
    if (!host.empty()) hosts.push_back(host);
  }
  if (hosts.empty()) {
    throw UserError("--engine parallel: found no hosts, expected --hosts a,b (: is this machine)");
  }
  return hosts;
}

/// The number of rows in a job. Without --bundle, one row is run here first: its time decides, and
/// what fails at once fails here.
std::size_t bundleOf(CampaignData& data, const fs::path& folder, std::vector<std::size_t>& rows,
                     const SweepOptions& options) {
  if (options.bundle > 0) return static_cast<std::size_t>(options.bundle);
  const std::int64_t begin = wallClock();
  const std::size_t first = rows.front();
  const EngineEnd end = runLocally(data, folder, {first}, {});
  if (data.survey.rows[first].kind != Kind::kDone) {
    throw std::runtime_error(
        fmt::format("row {}, run here first, has no result: {}", first,
                    end.note.empty() ? data.survey.rows[first].note : end.note));
  }
  rows.erase(rows.begin());
  const double seconds = static_cast<double>(wallClock() - begin) * 1e-6;
  const std::size_t size = bundleSize(rows.size(), seconds, kMostTasks);
  fmt::print("bundles  {} a job: one took {:.1f} s here\n",
             countText(static_cast<std::int64_t>(size), "run"), seconds);
  return size;
}

PageOptions pageOf(const SweepOptions& options) {
  return {.show = options.show, .figures = options.figures};
}

/// The real lab, or its rehearsal.
LiveMachine prepareLive(CampaignData& data, const fs::path& folder, const SweepOptions& options) {
  LiveMachine machine = labMachine(data.request.live->rehearsal);
  if (!options.until.empty())
    data.request.live->until_us = parseUntil(options.until, machine.now());
  if (options.take_back) takeBackRobots(folder, machine.now());
  const LivePlan& plan = *data.request.live;
  fmt::print("engine   {}, one run after another, each repeated up to {} times if it is marked{}\n",
             plan.rehearsal ? "a rehearsal in virtual time" : "the real lab", plan.tries,
             plan.until_us == 0 ? "" : "; until " + utcText(plan.until_us));
  std::fflush(stdout);
  return machine;
}

/// Plays the rows on the real lab.
EngineEnd playLive(CampaignData& data, const fs::path& folder, const std::vector<std::size_t>& rows,
                   const SweepOptions& options) {
  if (data.request.keep == Keep::kLogs || options.figures) {
    requireProgram("gnuplot", "gnuplot-nox");
  }
  requireDisk(data, folder, rows, 1);
  LiveMachine machine = prepareLive(data, folder, options);
  SweepProgress progress(data, folder, rows, pageOf(options), false);
  progress.update();
  machine.watch = [&] { progress.update(); };
  EngineEnd end = runLive(data, folder, rows, machine);
  fmt::print("time     {}\n", accountText(accountOf(readJournal(journalText(folder)).entries)));
  return end;
}

/// Runs what the plan of an adaptive campaign chooses.
EngineEnd runChosen(CampaignData& data, const fs::path& folder,
                    const std::vector<std::size_t>& rows, const SweepOptions& options) {
  if (data.request.keep == Keep::kLogs || options.figures) {
    requireProgram("gnuplot", "gnuplot-nox");
  }
  std::vector<std::size_t> first;
  for (const std::size_t row : rows) {
    const Kind kind = data.survey.rows[row].kind;
    if (kind == Kind::kFailed || kind == Kind::kStale) first.push_back(row);
  }
  const std::size_t jobs = jobsOf(options, rows.size());
  requireDisk(data, folder, affordableRows(data, rows), jobs);
  if (data.request.keep == Keep::kLogs) fs::create_directories(folder / names::kRuns);
  SweepProgress progress(data, folder, rows, pageOf(options), false);
  if (data.request.live) {
    LiveMachine machine = prepareLive(data, folder, options);
    machine.watch = [&] { progress.update(); };
    return runAdaptively(data, folder, first, [&](const std::vector<std::size_t>& chosen) {
      return runLive(data, folder, chosen, machine);
    });
  }
  return runAdaptively(data, folder, first, [&](const std::vector<std::size_t>& chosen) {
    return runLocally(data, folder, chosen, {.jobs = jobs, .watch = [&] { progress.update(); }});
  });
}

EngineEnd runEngine(CampaignData& data, const fs::path& folder, std::vector<std::size_t> rows,
                    const SweepOptions& options) {
  if (data.request.adaptive) return runChosen(data, folder, rows, options);
  if (data.request.live) return playLive(data, folder, rows, options);
  const bool local = options.engine == "local";
  const std::size_t jobs = jobsOf(options, rows.size());
  if (data.request.keep == Keep::kLogs || options.figures) {
    requireProgram("gnuplot", "gnuplot-nox");
  }
  requireDisk(data, folder, rows, local ? jobs : 1);
  if (data.request.keep == Keep::kLogs) fs::create_directories(folder / names::kRuns);
  if (local) {
    fmt::print("engine   {} at a time on this machine\n",
               countText(static_cast<std::int64_t>(jobs), "run"));
    std::fflush(stdout);
    SweepProgress progress(data, folder, rows, pageOf(options));
    return runLocally(data, folder, rows, {.jobs = jobs, .watch = [&] { progress.update(); }});
  }
  EngineOptions engine;
  engine.lab = options.lab_there.empty() ? installation().programs / "lab" : options.lab_there;
  engine.jobs = static_cast<std::size_t>(options.jobs);
  engine.slurm = options.slurm;
  engine.wait = options.wait;
  for (const fs::path& path : {fs::absolute(folder), engine.lab}) {
    requireScriptable(path, options.engine);
  }
  if (options.engine == "parallel") engine.hosts = hostsOf(options);
  engine.bundle = bundleOf(data, folder, rows, options);
  if (rows.empty()) return {};
  if (options.engine == "snakemake" || options.engine == "commands") {
    const auto lines = options.engine == "snakemake" ? writeSnakefile(folder, rows, engine)
                                                     : writeCommands(folder, rows, engine);
    for (const std::string& line : lines) fmt::print("{}\n", printable(line));
    return {.written_only = true};
  }
  SweepProgress progress(data, folder, rows, pageOf(options));
  engine.watch = [&] { progress.update(); };
  return options.engine == "slurm" ? runBySlurm(data, folder, rows, engine)
                                   : runByParallel(data, folder, rows, engine);
}

/// Options that go together, or do not.
void requireLiveOptions(const SweepOptions& options) {
  if (options.adaptive && options.engine != "local") {
    throw UserError(
        "--adaptive chooses runs by the results of those before, on this machine: leave out "
        "--engine");
  }
  const bool is_file = !fs::is_directory(options.input);
  if (options.live && (options.engine != "local" || options.jobs > 0)) {
    throw UserError("--live plays one run after another on the lab: leave out --engine and --jobs");
  }
  const bool asks = options.rest_s > 0 || !options.clear.empty() || !options.known.empty() ||
                    !options.until.empty() || options.rehearse || options.take_back;
  if (is_file && asks && !options.live) {
    throw UserError(
        "--rest, --clear, --known, --until, --rehearse and --take-back are for a campaign on the "
        "real lab: add --live");
  }
}

/// A campaign's folder may come from a stranger, and its files say which hosts and devices a run on
/// the real lab uses. @throws UserError unless the user asked for the real lab
void requireLiveAsked(const CampaignData& data, const SweepOptions& options) {
  const std::string campaign = options.input.string();
  if (isOnRealLab(data.request) && !options.live) {
    throw UserError(fmt::format(
        "{}: found a campaign on the real lab, with the hosts and devices that {} and {} name; to "
        "play it, add --live; --no-run makes its tables only",
        campaign, names::kRequest, names::kExperiment));
  }
  if (options.live && !data.request.live) {
    throw UserError(campaign +
                    ": found a simulated campaign, expected one on the real lab with --live; leave "
                    "--live out");
  }
  if (options.live && !isOnRealLab(data.request) && !options.rehearse) {
    throw UserError(campaign +
                    ": found a rehearsal, expected a campaign on the real lab with --live; add "
                    "--rehearse to continue the rehearsal");
  }
}

ExitCode conclude(const CampaignData& data, const fs::path& folder, const EngineEnd& end,
                  double seconds, const SweepOptions& options) {
  const std::size_t all = data.rows.size();
  const std::size_t done = data.survey.count(Kind::kDone);
  const std::size_t stale = data.survey.count(Kind::kStale);
  fmt::print("done     {} of {} runs{}\n", done + stale, all,
             seconds > 0 ? " in " + durationText(seconds) : "");
  if (data.survey.count(Kind::kFailed) > 0) {
    listRows(data, Kind::kFailed, "failed");
    fmt::print("failed   {} of {} runs; --retry tries them again\n",
               data.survey.count(Kind::kFailed), all);
  }
  if (!end.note.empty()) {
    fmt::print("stopped  {}; what is done stays, and {} sweep {}{} continues\n",
               printable(end.note), installation().command, printable(folder.string()),
               isOnRealLab(data.request) ? " --live" : "");
  }
  if (done + stale == 0 && end.disk_full) return kFailed;
  for (const std::string& line : writeTables(data, folder, pageOf(options))) {
    fmt::print("{}\n", printable(line));
  }
  fmt::print("table    {}\n", printable((folder / names::kTable).string()));
  fmt::print("page     {}\n",
             printable(fs::absolute(folder / names::kPage).lexically_normal().string()));
  if (end.interrupted) return kFailed;
  return done + stale == all || end.known ? kDone : kFailed;
}

void removeAbandoned(const fs::path& folder) {
  for (const char* part : {"", names::kResults, names::kSummaries, names::kFailures}) {
    removeAbandonedFiles(folder / part);
  }
}

}  // namespace

ExitCode sweep(const SweepOptions& options) {
  if (options.code) {
    fmt::print("{}\n", thisCode().text);
    return kDone;
  }
  if (!options.rows.empty()) return work(options);
  requireLiveOptions(options);
  const bool is_folder = fs::is_directory(options.input);
  if (is_folder) refuseRequestOptions(options);
  const fs::path folder = is_folder ? options.input : prepare(options);
  refuseCampaignLinks(folder);
  const FileLock lock = lockOf(folder);
  removeAbandoned(folder);
  CampaignData data = dataOf(readCampaign(folder));
  data.survey = surveyRows(folder, data.rows);
  describe(data, folder);
  describeProblems(data, folder, options.retry, options.redo_stale);
  const std::vector<std::size_t> rows =
      options.no_run ? std::vector<std::size_t>() : rowsToRun(data, options);
  if (is_folder && !rows.empty()) requireLiveAsked(data, options);
  catchSignals();
  EngineEnd end;
  double seconds = 0;
  if (!rows.empty()) {
    const std::int64_t begin = wallClock();
    end = runEngine(data, folder, rows, options);
    seconds = static_cast<double>(wallClock() - begin) * 1e-6;
    removeAbandoned(folder);
  }
  if (end.written_only) return kDone;
  return conclude(data, folder, end, seconds, options);
}

}  // namespace lab::runner::campaign
