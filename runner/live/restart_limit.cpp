#include "runner/live/restart_limit.hpp"

#include <fmt/format.h>

#include "common/math/units.hpp"

namespace lab::runner {

std::optional<std::int64_t> RestartLimit::noteDeath(std::int64_t now) {
  while (!deaths_.empty() && now - deaths_.front() >= kWindow_us) deaths_.pop_front();
  deaths_.push_back(now);
  if (deaths_.size() > kMost) return std::nullopt;
  if (deaths_.size() == 1) return now;
  return now + (kFirstPause_us << (deaths_.size() - 2));
}

std::string restartText(std::int64_t pause_us) {
  if (pause_us <= 0) return "was restarted";
  return fmt::format("is restarted in {} s", units::seconds(pause_us));
}

std::string tooOftenText() {
  return fmt::format("died too often ({} times in {} s)", RestartLimit::kMost + 1,
                     RestartLimit::kWindow_us / units::kSecond_us);
}

}  // namespace lab::runner
