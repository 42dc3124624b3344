#include "runner/live/progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <system_error>

#include "common/text/duration_text.hpp"

namespace lab::runner {
namespace {

constexpr double kPrints = 10;  // over the whole run, where the output is not a terminal
constexpr std::int64_t kShortest_us = 100'000;

std::int64_t steady_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Prints, even where nobody reads any more (lab run ... | head): the run goes on without a line.
template <class Print>
void withoutReader(const Print& print) {
  try {
    print();
  } catch (const std::system_error&) {
    if (std::freopen("/dev/null", "w", stdout) == nullptr) return;
  }
}

}  // namespace

std::string progressText(const Progress& progress) {
  std::string programs;
  for (const auto& [name, robots] : progress.robots_running) {
    programs += fmt::format("{}{} {}", programs.empty() ? "" : ", ", robots, name);
  }
  return fmt::format("{}{}{} left{} | light {} | {} robot{} seen | {} | {} lost",
                     progress.paused ? "paused, " : "", progress.at_most ? "at most " : "",
                     remainingTimeText(progress.left),
                     progress.stop.empty() ? "" : " | " + progress.stop,
                     progress.light.empty() ? "-" : progress.light, progress.robots_seen,
                     progress.robots_seen == 1 ? "" : "s", programs.empty() ? "no robot" : programs,
                     progress.lost);
}

ProgressLine::ProgressLine(double duration)
    : duration_(duration), terminal_(isatty(STDOUT_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_ && shown_) fmt::print("\n");
}

void ProgressLine::show(const Progress& progress) {
  withoutReader([&] { print(progress); });
}

void printLine(std::string_view text) {
  withoutReader([text] {
    fmt::print("{}{}\n", isatty(STDOUT_FILENO) == 1 ? "\r\033[K" : "", text);
    std::fflush(stdout);
  });
}

void ProgressLine::print(const Progress& progress) {
  if (!terminal_) {
    if (progress.elapsed < next_print_) return;
    next_print_ = progress.elapsed + duration_ / kPrints;
    fmt::print("running  {}\n", progressText(progress));
    std::fflush(stdout);
    return;
  }
  // Virtual time asks a thousand times a second.
  const std::int64_t now = steady_us();
  if (shown_ && now - last_shown_us_ < kShortest_us) return;
  last_shown_us_ = now;
  shown_ = true;
  fmt::print("\r\033[Krunning  {}", progressText(progress));
  std::fflush(stdout);
}

}  // namespace lab::runner
