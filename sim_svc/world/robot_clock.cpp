#include "sim_svc/world/robot_clock.hpp"

#include <cmath>

namespace lab::sim {

RobotClock::RobotClock(double phase_ms, double rate)
    : phase_ms_(phase_ms), rate_(rate), seconds_per_ms_(1 / (1000 * rate)) {}

std::int64_t RobotClock::localMs(double t) const {
  return static_cast<std::int64_t>(std::floor(phase_ms_ + 1000 * rate_ * t));
}

std::int64_t unwrapMs(std::uint32_t ms, std::int64_t near_ms) {
  const std::uint32_t ahead = ms - static_cast<std::uint32_t>(near_ms);
  return near_ms + static_cast<std::int32_t>(ahead);
}

}  // namespace lab::sim
