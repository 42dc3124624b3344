#pragma once

#include <cstdint>

#include "common/math/units.hpp"

namespace lab::gateway {

/// Limits the rate of messages by the messages' own time, so a replay at ten times the speed is
/// thinned like the run.
class RateLimit {
 public:
  /// @param rate [1/s], 0: everything
  explicit RateLimit(double rate) : period_us_(rate > 0 ? units::microseconds(1 / rate) : 0) {}

  /// Whether a message of this time passes. After a step of the time backwards the limit restarts.
  [[nodiscard]] bool admit(std::int64_t utime) {
    if (period_us_ == 0) return true;
    const std::int64_t early = next_utime_ - utime;
    if (early > 0 && early <= period_us_) return false;
    // Stays on a grid of times, so that 5 Hz of 60 Hz is exactly 5 Hz. A pause starts a new grid.
    const bool on_grid = early <= 0 && -early < period_us_;
    next_utime_ = (on_grid ? next_utime_ : utime) + period_us_;
    return true;
  }

 private:
  std::int64_t period_us_;
  std::int64_t next_utime_ = 0;
};

}  // namespace lab::gateway
