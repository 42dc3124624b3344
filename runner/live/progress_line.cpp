#include "runner/live/progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "common/text/duration_text.hpp"
#include "common/text/format.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/print_line.hpp"

namespace lab::runner {
namespace {

constexpr double kPrints = 10;  // lines per run when the output is not a terminal
constexpr std::int64_t kShortest_us = 100'000;

std::int64_t steady_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::string progressText(const Progress& progress) {
  std::string programs;
  for (const auto& [name, robots] : progress.robots_running) {
    programs += fmt::format("{}{} {}", programs.empty() ? "" : ", ", robots, name);
  }
  std::string stopped;
  if (progress.robots_stopped > 0) {
    stopped = fmt::format(" | {} STOPPED: lab stop --clear lets them go on",
                          countText(static_cast<std::int64_t>(progress.robots_stopped), "robot"));
  }
  return fmt::format(
      "{}{}{} left{}{} | light {} | {} robot{} seen | {} | {} message{} lost",
      progress.paused ? "paused, " : "", progress.at_most ? "at most " : "",
      remainingTimeText(progress.left), stopped, progress.stop.empty() ? "" : " | " + progress.stop,
      progress.light.empty() ? "-" : progress.light, progress.robots_seen,
      progress.robots_seen == 1 ? "" : "s", programs.empty() ? "no program" : programs,
      progress.lost, progress.lost == 1 ? "" : "s");
}

namespace {

const char* labelOf(const Progress& progress) { return progress.begun ? "running  " : "starting "; }

}  // namespace

ProgressLine::ProgressLine(double duration)
    : duration_(duration), terminal_(isatty(STDOUT_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_ && shown_) fmt::print("\n");
}

void ProgressLine::show(const Progress& progress) {
  evenWithoutReader([&] { print(progress); });
}

void ProgressLine::print(const Progress& progress) {
  if (!terminal_) {
    if (progress.begun ? progress.elapsed < next_print_ : shown_) return;
    if (progress.begun) next_print_ = progress.elapsed + duration_ / kPrints;
    shown_ = true;
    fmt::print("{}{}\n", labelOf(progress), printable(progressText(progress)));
    std::fflush(stdout);
    return;
  }
  // In virtual time this is called up to a thousand times a second.
  const std::int64_t now = steady_us();
  if (shown_ && now - last_shown_us_ < kShortest_us) return;
  last_shown_us_ = now;
  shown_ = true;
  fmt::print("\r\033[K{}{}", labelOf(progress), printable(progressText(progress)));
  std::fflush(stdout);
}

}  // namespace lab::runner
