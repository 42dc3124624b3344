/// How often results are computed.
#pragma once

#include <cstdint>
#include <optional>

namespace lab::analysis {

/// Results once a second, and less often when they are expensive: computing them takes at most a
/// quarter of the time, so that samples and heartbeats go on. In virtual time nothing is expensive.
class RoundPace {
 public:
  [[nodiscard]] bool isDue(std::int64_t now) const { return now >= next_utime_; }

  /// Results were computed.
  /// @return the time between results [s], if it is twice as long as it ever was
  [[nodiscard]] std::optional<std::int64_t> note(std::int64_t begin, std::int64_t end) {
    const std::int64_t period_us = kShare * (end - begin);
    next_utime_ = begin + period_us;
    const std::int64_t seconds = (period_us + kSecond_us - 1) / kSecond_us;
    if (seconds < 2 * longest_s_) return std::nullopt;
    longest_s_ = seconds;
    return seconds;
  }

 private:
  static constexpr std::int64_t kShare = 4;
  static constexpr std::int64_t kSecond_us = 1'000'000;
  std::int64_t next_utime_ = 0;
  std::int64_t longest_s_ = 1;
};

}  // namespace lab::analysis
