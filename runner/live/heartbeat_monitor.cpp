#include "runner/live/heartbeat_monitor.hpp"

#include <algorithm>
#include <utility>

#include "common/math/units.hpp"

namespace lab::runner {

void HeartbeatMonitor::beat(const std::string& name) {
  const auto found = heartbeats_.find(name);
  if (found == heartbeats_.end()) return;
  Heartbeat& pulse = found->second;
  if (pulse.silent)
    again_.push_back({name, false, (clock_us_ - pulse.heard_us) / units::kSecond_us});
  pulse = {.heard_us = clock_us_, .timeout_us = kTimeout_us};
}

std::vector<HeartbeatMonitor::Change> HeartbeatMonitor::look(std::int64_t now) {
  if (looked_utime_ != 0) {
    clock_us_ += std::clamp<std::int64_t>(now - looked_utime_, 0, kLongestStep_us);
  }
  looked_utime_ = now;
  std::vector<Change> changes = std::exchange(again_, {});
  for (auto& [name, pulse] : heartbeats_) {
    const std::int64_t silence_us = clock_us_ - pulse.heard_us;
    if (pulse.silent || silence_us < pulse.timeout_us) continue;
    pulse.silent = true;
    changes.push_back({name, true, silence_us / units::kSecond_us});
  }
  return changes;
}

}  // namespace lab::runner
