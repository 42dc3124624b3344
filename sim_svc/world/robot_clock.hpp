/// The clock of a simulated robot.
#pragma once

#include <cstdint>

namespace lab::sim {

/// A robot counts milliseconds with its own phase and rate:
/// local = phase + 1000 rate t, with t the world time [s].
class RobotClock {
 public:
  RobotClock() = default;

  /// @param phase_ms reading of the robot's clock at world time 0; may be fractional
  /// @param rate of the robot's clock; 1 is exact
  RobotClock(double phase_ms, double rate);

  /// The reading of the robot's clock at world time t, in whole milliseconds.
  [[nodiscard]] std::int64_t localMs(double t) const;

  /// The world time at which the robot's clock changes to `local_ms`.
  [[nodiscard]] double worldTime(std::int64_t local_ms) const {
    return (static_cast<double>(local_ms) - phase_ms_) * seconds_per_ms_;
  }

  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] double phaseMs() const { return phase_ms_; }

 private:
  double phase_ms_ = 0;
  double rate_ = 1;
  double seconds_per_ms_ = 1e-3;
};

/// Unwraps the robot's 32-bit count `ms`: the 64-bit count that is nearest to `near_ms`.
[[nodiscard]] std::int64_t unwrapMs(std::uint32_t ms, std::int64_t near_ms);

}  // namespace lab::sim
