#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/udpm_url.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/math/units.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/spy_table.hpp"
#include "runner/runs/lab_registry.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kShow_us = 1'000'000;

/// A table of every stream on a bus, once a second.
class Spy {
 public:
  Spy(std::string name, const std::string& url) : name_(std::move(name)), bus_(url) {
    bus_.subscribeAll([this](const Packet& packet) { table_.take(packet); });
  }

  void execute(const std::optional<double>& longest_s) {
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.onSignals({SIGINT, SIGTERM}, [this](int) { loop_.stop(); });
    const std::int64_t start = loop_.now();
    last_show_utime_ = start;
    loop_.every(kShow_us, start + kShow_us, [this] { show(); });
    if (longest_s) loop_.at(start + units::microseconds(*longest_s) + 1, [this] { loop_.stop(); });
    loop_.run();
  }

 private:
  void show() {
    const std::int64_t now = loop_.now();
    const double interval = units::seconds(now - last_show_utime_);
    last_show_utime_ = now;
    if (isatty(STDOUT_FILENO) == 1) fmt::print("\033[H\033[2J");
    fmt::print("{}\n{}", name_, table_.text(interval, now));
    for (const std::string& line : bus_.refused().linesSince({})) fmt::print("{}\n", line);
    fmt::print("\n");
    std::fflush(stdout);
  }

  std::string name_;
  AsioLoop loop_;
  LcmBus bus_;
  SpyTable table_;
  std::int64_t last_show_utime_ = 0;
};

}  // namespace

ExitCode spy(const SpyOptions& options) {
  if (!options.url.empty()) {
    if (!parseUdpmUrl(options.url)) {
      throw UserError("--lcm-url: found " + options.url +
                      ", expected the URL of a bus as lab run prints it: "
                      "udpm://239.255.76.67:7667?ttl=0");
    }
    Spy(options.url, options.url).execute(options.seconds);
  } else {
    const RunningLab lab = findLab(options.lab);
    Spy(lab.name, lab.url).execute(options.seconds);
  }
  return kDone;
}

}  // namespace lab::runner
