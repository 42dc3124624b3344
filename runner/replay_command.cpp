#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <lab/clock_t.hpp>

#include "common/asio_loop.hpp"
#include "common/channels.hpp"
#include "common/lcm_bus.hpp"
#include "common/units.hpp"
#include "report/log_source.hpp"
#include "runner/commands.hpp"
#include "runner/lab_registry.hpp"
#include "runner/log_player.hpp"
#include "runner/network.hpp"
#include "runner/raw_terminal.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kTick_us = 2'000;
constexpr std::int64_t kShow_us = 250'000;
constexpr std::int64_t kClock_us = 20'000;

/// Sends a log's messages onto a bus of its own.
class Player {
 public:
  Player(const std::vector<LogEvent>& events, const ReplayOptions& options, const std::string& url)
      : events_(events),
        options_(options),
        bus_(url),
        clock_(events.front().utime, loop_.now(), options.speed) {}

  void execute() {
    loop_.onSignals({SIGINT, SIGTERM}, [this](int) { loop_.stop(); });
    if (terminal_.active()) loop_.onReadable(STDIN_FILENO, [this] { key(); });
    loop_.every(kTick_us, loop_.now(), [this] { send(); });
    if (needsClock()) loop_.every(kClock_us, loop_.now(), [this] { sendClock(); });
    loop_.every(kShow_us, loop_.now(), [this] { show(); });
    loop_.run();
    show();
    fmt::print("\n");
  }

 private:
  /// A log of a live lab holds no CLOCK, and its time is not that of the wall any more.
  [[nodiscard]] bool needsClock() const {
    const auto& wanted = options_.channels;
    const bool asked =
        wanted.empty() || std::ranges::find(wanted, channels::kClock) != wanted.end();
    return asked &&
           std::ranges::find(events_, channels::kClock, &LogEvent::channel) == events_.end();
  }

  void sendClock() {
    clock_t message{};
    message.utime = std::min(clock_.logTime(loop_.now()), events_.back().utime);
    message.sender = "replay";
    message.instance = started_;
    message.seq = ++clock_seq_;
    message.rate = clock_.paused() ? 0 : options_.speed;
    bus_.publish(channels::kClock, encode(message));
  }

  void key() {
    char letter = 0;
    if (read(STDIN_FILENO, &letter, 1) != 1 || letter != ' ') return;
    clock_.paused() ? clock_.resume(loop_.now()) : clock_.pause(loop_.now());
  }

  void send() {
    const std::int64_t until = clock_.logTime(loop_.now());
    for (; next_ < events_.size() && events_[next_].utime <= until; ++next_) {
      const LogEvent& event = events_[next_];
      bus_.publish(event.channel, asReplay(event.channel, event.data));
    }
    if (next_ < events_.size()) return;
    if (!options_.loop) {
      loop_.stop();
      return;
    }
    next_ = 0;
    clock_ = ReplayClock(events_.front().utime, loop_.now(), options_.speed);
  }

  /// A quiet stretch of a log must not look like a hang: the time runs on.
  void show() const {
    const std::int64_t first = events_.front().utime;
    const std::int64_t last = events_.back().utime;
    const std::int64_t now = std::min(clock_.logTime(loop_.now()), last);
    fmt::print("{}replay   {:.1f} of {:.1f} s, {} of {} messages{}{}",
               terminal_.active() ? "\r\033[K" : "", units::seconds(now - first),
               units::seconds(last - first), next_, events_.size(),
               clock_.paused() ? ", paused (space goes on)" : "", terminal_.active() ? "" : "\n");
    std::fflush(stdout);
  }

  const std::vector<LogEvent>& events_;
  const ReplayOptions& options_;
  AsioLoop loop_;
  LcmBus bus_;
  ReplayClock clock_;
  RawTerminal terminal_;
  std::size_t next_ = 0;
  std::int64_t started_ = loop_.now();
  std::int64_t clock_seq_ = 0;
};

}  // namespace

ExitCode replay(const ReplayOptions& options) {
  const std::vector<fs::path> log_files = report::logFiles(options.log);
  const fs::path& log = log_files.front();
  const std::vector<LogEvent> events = selectEvents(
      log_files, {options.from, options.to, {options.channels.begin(), options.channels.end()}});
  if (events.empty()) {
    throw UserError(log.string() +
                    " holds no message between --from and --to on the wanted channels");
  }
  const std::string url = lcmUrl(choosePort(options.port));
  const std::string name = "replay-" + fs::absolute(log).parent_path().filename().string();
  const Registration registration(
      {name, url, getpid(), fs::absolute(log).parent_path().string(), true});
  fmt::print("lab      {}\nbus      {}\n", name, url);
  Player(events, options, url).execute();
  return kDone;
}

}  // namespace lab::runner
