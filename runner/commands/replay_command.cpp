#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <lab/clock_t.hpp>
#include <lab/robot_state_t.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/log_source.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/service/node.hpp"
#include "common/text/format.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/log_playback.hpp"
#include "runner/commands/raw_terminal.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/live/request_log.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kReplayTick_us = 2'000;
constexpr std::int64_t kReplayShow_us = 250'000;
constexpr std::int64_t kClock_us = 20'000;
constexpr std::int64_t kReplayStatus_us = 200'000;  // 5 Hz
constexpr std::int64_t kSupervise_us = 100'000;
constexpr const char* kReplayName = "replay";

/// Sends the messages of a log onto a bus of its own.
class Player {
 public:
  /// @param page the dashboard, nullptr: none
  Player(LogEvents& log, const ReplayOptions& options, const std::string& url,
         const std::string& run, DashboardProcess* page)
      : log_(log),
        options_(options),
        page_(page),
        bus_(url),
        node_(bus_, loop_, {kReplayName, robot_state_t::REPLAY, loop_.now()}),
        playback_(log, run, options.speed,
                  options.loop      ? AtEnd::kLoop
                  : page != nullptr ? AtEnd::kPause
                                    : AtEnd::kEnd,
                  loop_.now()) {
    node_.subscribe<experiment_command_t>(channels::kExperimentCommand,
                                          [this](const experiment_command_t& command) {
                                            request_log_.take(command);
                                            sendStatus();
                                            if (playback_.over()) loop_.stop();
                                          });
  }

  void execute() {
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.onSignals({SIGINT, SIGTERM, SIGHUP}, [this](int) { loop_.stop(); });
    if (terminal_.active()) loop_.onReadable(STDIN_FILENO, [this] { key(); });
    loop_.every(kReplayTick_us, loop_.now(), [this] { send(); });
    if (needsClock()) loop_.every(kClock_us, loop_.now(), [this] { sendClock(); });
    loop_.every(kReplayStatus_us, loop_.now(), [this] { sendStatus(); });
    if (page_ != nullptr) loop_.every(kSupervise_us, loop_.now(), [this] { supervisePage(); });
    loop_.every(kReplayShow_us, loop_.now(), [this] { show(); });
    loop_.run();
    show();
    fmt::print("\n");
  }

 private:
  /// Whether the user asked for the channel.
  [[nodiscard]] bool isAsked(std::string_view channel) const {
    const auto& wanted = options_.channels;
    return wanted.empty() || std::ranges::find(wanted, channel) != wanted.end();
  }

  /// A log of a real-time run has no CLOCK, but the time of its replay is not the wall clock.
  [[nodiscard]] bool needsClock() const {
    return isAsked(channels::kClock) && !log_.has(channels::kClock);
  }

  void sendClock() {
    clock_t message{};
    message.utime = playback_.recordedTime(loop_.now());
    message.rate = playback_.rate();
    node_.publish(channels::kClock, message);
  }

  void sendStatus() {
    experiment_status_t status = playback_.status(loop_.now());
    request_log_.write(status);
    node_.publish(channels::kExperimentStatus, status);
  }

  void supervisePage() {
    page_->supervise(loop_.now(), [](const std::string& what) { printLine("web      " + what); });
  }

  void key() {
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) != 1 || letter != ' ') return;
    playback_.pauseOrResume(loop_.now());
    sendStatus();
  }

  void send() {
    const std::int64_t now = loop_.now();
    if (playback_.advance(now)) sendStatus();
    if (playback_.over()) {
      loop_.stop();
      return;
    }
    playback_.play(now, [this](std::string_view channel, Bytes message) {
      node_.forward(channel, asReplay(channel, message));
    });
  }

  /// Called also when nothing is sent, so that a gap in the log does not look like a hang.
  void show() const {
    fmt::print("{}replay   {:.1f} of {:.1f} s, {} of {} messages{}{}",
               terminal_.active() ? "\r\033[K" : "", playback_.elapsed(loop_.now()),
               playback_.length(), playback_.sent(), log_.all().size(),
               playback_.paused() ? ", paused (the space bar continues)" : "",
               terminal_.active() ? "" : "\n");
    std::fflush(stdout);
  }

  LogEvents& log_;
  const ReplayOptions& options_;
  DashboardProcess* page_;
  AsioLoop loop_;
  LcmBus bus_;
  Node node_;
  LogPlayback playback_;
  RequestLog request_log_{[this](const experiment_command_t& command) {
    return playback_.execute(command, loop_.now());
  }};
  RawTerminal terminal_;
};

/// @param run the folder of the run
/// @param output file for the output of the dashboard
void startPage(std::optional<DashboardProcess>& page, const ReplayOptions& options,
               const fs::path& run, const std::string& url, const fs::path& output) {
  const fs::path experiment = run / files::kExperiment;
  page.emplace(DashboardOptions{.program = options.programs / kObserverService,
                                .url = url,
                                .experiment = fs::exists(experiment) ? experiment : fs::path(),
                                .runs = run.parent_path(),
                                .address_file = registryFile(kPageFile),
                                .output = output,
                                .this_machine_only = true});  // the run may be a stranger's
  page->start([](const std::string& what) { printLine("web      " + what); });
}

/// Why no message of the log is played.
std::string nothingToPlay(const ReplayOptions& options, const fs::path& log,
                          const LogEvents& events) {
  if (!options.channels.empty() && !events.hasSelectedChannel()) {
    return fmt::format(
        "{}: found no message on --channel {}, expected one of its channels: {} "
        "(EXPERIMENT_STATUS and EXPERIMENT_COMMAND of a replay are its own)",
        log.string(), fmt::join(options.channels, ", "), fmt::join(events.logChannels(), ", "));
  }
  return fmt::format(
      "{}: found no message{} between {:g} s and {}; the log lasts {:.1f} s: change --from or --to",
      log.string(), options.channels.empty() ? "" : " on the chosen channels", options.from,
      options.to ? fmt::format("{:g} s", *options.to) : "its end", events.logLength());
}

}  // namespace

ExitCode replay(const ReplayOptions& options) {
  if (options.to && options.from >= *options.to) {
    throw UserError(fmt::format("--from {:g} --to {:g}: found an end before the begin",
                                options.from, *options.to));
  }
  const std::vector<fs::path> log_files = report::logFiles(options.log);
  const fs::path& log = log_files.front();
  LogEvents events(log_files, {options.from,
                               options.to,
                               {options.channels.begin(), options.channels.end()},
                               options.max_gap});
  if (events.all().empty()) {
    throw UserError(nothingToPlay(options, log, events));
  }
  const std::string url = lcmUrl(choosePort(options.port));
  // canonical(): the folder `.` must get its real name.
  const fs::path run = fs::canonical(fs::absolute(log).parent_path());
  const Registration registration(
      {"replay-" + run.filename().string(), url, getpid(), run.string(), true});
  fmt::print("lab      {}\nbus      {}\n", registration.name(), url);
  const ShortenedGaps& gaps = events.gaps();
  if (gaps.gaps > 0) {
    fmt::print(
        "gaps     {} in the log shortened to {:g} s, the longest lasts {}; --max-gap sets "
        "the limit\n",
        gaps.gaps, options.max_gap, durationText(gaps.longest));
  }
  if (gaps.steps_back > 0) {
    fmt::print("clock    set back {} in the log; the replay goes on there\n",
               gaps.steps_back == 1 ? "once" : fmt::format("{} times", gaps.steps_back));
  }
  if (events.unsendable() > 0) {
    fmt::print(
        "left out {} messages that no bus carries: channel names above 63 characters or messages "
        "above 16 MB\n",
        events.unsendable());
  }
  std::fflush(stdout);
  const RegistryFile output(".web.txt");
  std::optional<DashboardProcess> page;
  if (options.web) startPage(page, options, run, url, output.path());
  Player(events, options, url, run.filename().string(), page ? &*page : nullptr).execute();
  return kDone;
}

}  // namespace lab::runner
