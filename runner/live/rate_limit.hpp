/// A bound on how often something is done.
#pragma once

#include <algorithm>
#include <cstdint>

namespace lab::runner {

/// Allows `most` at once, and as many again in `period_us`. No clock of its own.
class RateLimit {
 public:
  RateLimit(int most, std::int64_t period_us)
      : most_(most), period_us_(period_us), left_us_(period_us) {}

  /// Whether one more is allowed now.
  [[nodiscard]] bool allows(std::int64_t now) {
    left_us_ = std::clamp(left_us_ + std::max<std::int64_t>(now - last_utime_, 0), std::int64_t{0},
                          period_us_);
    last_utime_ = now;
    const std::int64_t price_us = period_us_ / most_;
    if (left_us_ < price_us) return false;
    left_us_ -= price_us;
    return true;
  }

 private:
  std::int64_t most_;
  std::int64_t period_us_;
  std::int64_t left_us_;  ///< what is allowed now, in time that it took to be allowed
  std::int64_t last_utime_ = 0;
};

}  // namespace lab::runner
