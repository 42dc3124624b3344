#include "runner/campaign/queue/queue_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/child_process.hpp"
#include "common/process/installation.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/queue/campaign_queue.hpp"
#include "runner/campaign/sweep_command.hpp"
#include "runner/command_line/command_line_parts.hpp"
#include "runner/command_line/experiment_lookup.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

using State = QueuedCampaign::State;

constexpr const char* kQueueFile = "queue.json";
constexpr const char* kChangeLock = "queue.lock";   // held for a moment
constexpr const char* kRunLock = "queue.run.lock";  // held by lab queue run
constexpr std::chrono::milliseconds kQueueStep{200};

/// Changes the queue's file while nobody else does.
template <class Change>
void changeQueue(const fs::path& campaigns, const Change& change) {
  fs::create_directories(campaigns);
  std::optional<FileLock> lock;
  while (!(lock = FileLock::tryLock(campaigns / kChangeLock))) {
    std::this_thread::sleep_for(kQueueStep);
  }
  const fs::path file = campaigns / kQueueFile;
  const std::string text = fs::exists(file) ? readFileText(file, file_kinds::kText) : "";
  std::vector<QueuedCampaign> queue = readQueue(text, file.string());
  change(queue);
  const std::string changed = queueText(queue);
  if (changed != text) replaceFile(file, changed, Sync::kYes);
}

/// Parses a command line of lab sweep as lab sweep does, and runs nothing.
/// @return false if it only asked for help, which is printed. @throws UserError
bool parseSweep(const std::vector<std::string>& arguments, CLI::App& app) {
  Chosen chosen;
  addSweep(app, chosen);
  std::vector<const char*> words{"lab", "sweep"};
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  return !parseCommandLine(app, static_cast<int>(words.size()), words.data());
}

/// The options of lab queue run that a campaign needs, because the queue's file lies in a folder
/// that may be a stranger's.
QueueOptions neededOptions(const QueuedCampaign& campaign) {
  QueueOptions needed;
  CLI::App app{"", installation().command};
  try {
    if (!parseSweep(campaign.arguments, app)) return needed;
  } catch (const UserError&) {
    return needed;  // lab sweep says what is wrong, and this campaign fails
  }
  const CLI::App* sweep = app.get_subcommand("sweep");
  const auto given = [&](const char* option) { return sweep->get_option(option)->count() > 0; };
  const auto engine = sweep->get_option("--engine")->as<std::string>();
  needed.live = given("--live") && !given("--rehearse");
  needed.engines =
      engine == "slurm" || engine == "parallel" || given("--lab-there") || given("--bundle-file");
  return needed;
}

/// " --live --engines", as far as a campaign needs them.
std::string optionsText(const QueueOptions& needed) {
  return std::string(needed.live ? " --live" : "") + (needed.engines ? " --engines" : "");
}

/// Why a campaign must not be run; empty if it may.
std::string refusalOf(const QueuedCampaign& campaign, const QueueOptions& options) {
  const QueueOptions needed = neededOptions(campaign);
  const bool robots = needed.live && !options.live;
  if (!robots && (!needed.engines || options.engines)) return {};
  return fmt::format(
      "{}: it {}; to allow that, if you added it: lab queue run{}", lineOf(campaign),
      robots ? "drives the robots of the real lab" : "starts programs on this machine or on others",
      optionsText(needed));
}

/// Before anything is started: later nobody may be there. @throws UserError
void requireAllowed(const std::vector<QueuedCampaign>& queue, const QueueOptions& options) {
  for (const QueuedCampaign& campaign : queue) {
    if (campaign.state != State::kWaiting && campaign.state != State::kRunning) continue;
    if (const std::string refusal = refusalOf(campaign, options); !refusal.empty()) {
      throw UserError(refusal);
    }
  }
}

/// @return false if a command line of lab sweep only asked for help, which is printed.
/// @throws UserError
bool checkArguments(const std::vector<std::string>& arguments) {
  CLI::App app{"", installation().command};
  if (!parseSweep(arguments, app)) return false;
  const auto input = app.get_subcommand("sweep")->get_option("FILE|CAMPAIGN")->as<std::string>();
  if (fs::is_directory(input)) return true;
  const fs::path file = findExperiment(input, installation().experiments);
  const std::string problem = regularFileProblem(file, file_kinds::kExperiment);
  if (!problem.empty()) throw UserError(fmt::format("{}: {}", file.string(), problem));
  return true;
}

/// Runs lab sweep with the terminal of this process.
int runSweep(const QueuedCampaign& campaign) {
  ChildSettings settings{.arguments = {(installation().programs / "lab").string(), "sweep"},
                         .folder = campaign.folder,
                         .input = ChildSettings::kInherited,
                         .output = ChildSettings::kInherited,
                         .errors = ChildSettings::kInherited,
                         .death_signal = SIGTERM};
  settings.arguments.insert(settings.arguments.end(), campaign.arguments.begin(),
                            campaign.arguments.end());
  ChildProcess sweep(settings);
  bool told = false;
  while (!sweep.waitFor(kQueueStep)) {
    if (wasInterrupted() && !std::exchange(told, true)) sweep.signal(SIGINT);
  }
  return sweep.code();
}

}  // namespace

ExitCode addToQueue(const QueueOptions& options) {
  if (!checkArguments(options.arguments)) return kDone;
  changeQueue(options.campaigns, [&](std::vector<QueuedCampaign>& queue) {
    QueuedCampaign campaign;
    for (const QueuedCampaign& other : queue) {
      campaign.number = std::max(campaign.number, other.number);
    }
    ++campaign.number;
    campaign.arguments = options.arguments;
    campaign.folder = fs::current_path().string();
    const std::string needed = optionsText(neededOptions(campaign));
    fmt::print("{}{}\n", printable(lineOf(campaign)),
               needed.empty() ? "" : "; it runs with: lab queue run" + needed);
    queue.push_back(std::move(campaign));
  });
  return kDone;
}

ExitCode listQueue(const QueueOptions& options) {
  changeQueue(options.campaigns, [](std::vector<QueuedCampaign>& queue) {
    if (queue.empty()) fmt::print("no campaign is in the queue: lab queue add FILE ... adds one\n");
    for (const QueuedCampaign& campaign : queue) fmt::print("{}\n", printable(lineOf(campaign)));
  });
  return kDone;
}

ExitCode removeFromQueue(const QueueOptions& options) {
  changeQueue(options.campaigns, [&](std::vector<QueuedCampaign>& queue) {
    const auto found = std::ranges::find(queue, options.number, &QueuedCampaign::number);
    if (found == queue.end()) {
      throw UserError(fmt::format("remove {}: there is no such number in the queue (lab queue)",
                                  options.number));
    }
    if (found->state == State::kRunning) {
      throw UserError(fmt::format(
          "remove {}: this campaign is running, or was interrupted; end lab queue run first by "
          "Ctrl-C, or let it end",
          options.number));
    }
    queue.erase(found);
  });
  return kDone;
}

ExitCode runQueue(const QueueOptions& options) {
  fs::create_directories(options.campaigns);
  const auto lock = FileLock::tryLock(options.campaigns / kRunLock);
  if (!lock) {
    throw UserError(
        fmt::format("{}: another lab queue run works on this queue", options.campaigns.string()));
  }
  changeQueue(options.campaigns, [&](const auto& queue) { requireAllowed(queue, options); });
  catchSignals();
  bool all = true;
  while (!wasInterrupted()) {
    std::optional<QueuedCampaign> next;
    changeQueue(options.campaigns, [&](std::vector<QueuedCampaign>& queue) {
      const auto index = nextOf(queue);
      if (!index) return;
      QueuedCampaign& campaign = queue[*index];
      campaign.state = State::kRunning;
      if (campaign.begin_us == 0) campaign.begin_us = wallClock();
      next = campaign;
    });
    if (!next) break;
    fmt::print("queue    {}\n", printable(lineOf(*next)));
    std::fflush(stdout);
    // One that was added meanwhile.
    const std::string refusal = refusalOf(*next, options);
    if (!refusal.empty()) fmt::print(stderr, "lab: {}\n", printable(refusal));
    const int code = refusal.empty() ? runSweep(*next) : static_cast<int>(kBadInput);
    if (wasInterrupted()) break;  // it stays "running", and is continued
    all = all && code == kDone;
    changeQueue(options.campaigns, [&](std::vector<QueuedCampaign>& queue) {
      for (QueuedCampaign& campaign : queue) {
        if (campaign.number != next->number) continue;
        campaign.state = code == kDone ? State::kDone : State::kFailed;
        campaign.end_us = wallClock();
        campaign.exit_code = code;
      }
    });
  }
  return all && !wasInterrupted() ? kDone : kFailed;
}

void addQueue(CLI::App& app, Chosen& chosen) {
  auto options = std::make_shared<QueueOptions>();
  CLI::App* command = app.add_subcommand("queue", summaryOf("queue"));
  command->add_option("--campaigns", options->campaigns, "Folder of the queue")
      ->capture_default_str();
  command->require_subcommand(0, 1);
  CLI::App* add = command->add_subcommand("add",
                                          "Append a campaign: lab queue add FILE ..., with "
                                          "the arguments of lab sweep");
  add->prefix_command();
  CLI::App* remove = command->add_subcommand("remove", "Take a campaign out of the queue");
  remove->add_option("NUMBER", options->number, "As lab queue lists it")->required();
  CLI::App* run = command->add_subcommand(
      "run", "Run the campaigns one after another; after a restart of the computer, continue");
  run->add_flag("--live", options->live, "Also run campaigns on the real lab");
  run->add_flag("--engines", options->engines,
                "Also run campaigns that start programs on this machine or on others (--engine, "
                "--lab-there)");
  command->callback([&chosen, options, add, remove, run] {
    options->arguments = add->remaining();
    const bool adds = add->parsed();
    const bool removes = remove->parsed();
    const bool runs = run->parsed();
    chosen = [options, adds, removes, runs] {
      if (adds) return static_cast<int>(addToQueue(*options));
      if (removes) return static_cast<int>(removeFromQueue(*options));
      if (runs) return static_cast<int>(runQueue(*options));
      return static_cast<int>(listQueue(*options));
    };
  });
}

}  // namespace lab::runner::campaign
