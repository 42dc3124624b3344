#include "runner/command_line/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lab::runner {
namespace {

constexpr int kBar = 24;           // characters
constexpr double kInterval = 0.1;  // [s] between two lines

}  // namespace

std::string progressBarText(std::int64_t done, std::int64_t length, double seconds,
                            const char* unit) {
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  if (length <= 0) return fmt::format("{} {}, {:.0f} a second", done, unit, rate);
  const double share =
      std::clamp(static_cast<double>(done) / static_cast<double>(length), 0.0, 1.0);
  const auto full = static_cast<std::size_t>(std::lround(share * kBar));
  std::string text = fmt::format("[{}{}] {} of {} {}, {:.0f} a second", std::string(full, '#'),
                                 std::string(kBar - full, '.'), done, length, unit, rate);
  if (rate > 0) {
    const double left = static_cast<double>(std::max<std::int64_t>(0, length - done)) / rate;
    text += fmt::format(", {:.0f} s left", std::ceil(left));
  }
  return text;
}

ProgressBar::ProgressBar(std::int64_t length, const char* unit)
    : length_(length), unit_(unit), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::int64_t done) {
  if (!terminal_) return;
  const double now = seconds();
  if (now < next_) return;
  next_ = now + kInterval;
  shown_ = true;
  std::fprintf(stderr, "\r\033[K%s", progressBarText(done, length_, now, unit_).c_str());
  std::fflush(stderr);
}

double ProgressBar::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

}  // namespace lab::runner
