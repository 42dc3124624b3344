/// The clock of a simulated robot against the world's.
#pragma once

#include <cstdint>

namespace lab::sim {

/// A robot counts milliseconds from a phase of its own at a rate of its own:
/// local = phase + 1000 rate t, with t the world's seconds.
class RobotClock {
 public:
  RobotClock() = default;

  /// @param phase_ms what the robot's clock shows at world time 0; may be fractional
  /// @param rate of the robot's clock, 1 when it is right
  RobotClock(double phase_ms, double rate);

  /// The whole milliseconds that the robot's clock shows at world time t.
  [[nodiscard]] std::int64_t localMs(double t) const;

  /// The world time at which the robot's clock turns to `local_ms`.
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

/// The robot's 32-bit count `ms` as a 64-bit one, given a 64-bit time less than 24 days from it.
[[nodiscard]] std::int64_t unwrapMs(std::uint32_t ms, std::int64_t near_ms);

}  // namespace lab::sim
