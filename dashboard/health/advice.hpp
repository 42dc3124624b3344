/// What is wrong, in words, and what to do.
#pragma once

#include <cstdint>
#include <lab/light_status_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dashboard/health/health_view.hpp"
#include "dashboard/views/robots_view.hpp"
#include "dashboard/views/run_info.hpp"

namespace lab::dashboard {

struct Advice {
  enum class Level { kError, kWarn, kInfo };

  Level level = Level::kInfo;
  std::string what;
  std::string way_out;
};

/// Of the lab as it is. Nobody is blamed for silence once the run has ended, nor for that of a
/// played log, which is paused, jumps and is played faster.
struct AdviceFacts {
  const RunInfo& run_info;
  const HealthView& health;
  const RobotsView& robots;
  const std::optional<light_status_t>& light;
  std::int64_t light_utime = 0;  ///< when it was heard
  std::int64_t bus_utime = 0;    ///< when anything was heard from others, 0: never
  bool ended = false;
  std::int64_t now = 0;

  [[nodiscard]] bool isLive() const { return !ended && !run_info.replay(); }
};

/// Errors first.
[[nodiscard]] std::vector<Advice> adviceOn(const AdviceFacts& facts);

/// Of topic `health`.
[[nodiscard]] Json adviceJson(const std::vector<Advice>& advice);

}  // namespace lab::dashboard
