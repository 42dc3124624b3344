/// Texts that say what is wrong in the lab and what to do.
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
  std::string remedy;
};

/// The state of the lab. After the end of a run and while a log is replayed, silence is normal and
/// gives no advice: a replay can be paused, jump and run faster.
struct AdviceFacts {
  const RunInfo& run_info;
  const HealthView& health;
  const RobotsView& robots;
  const std::optional<light_status_t>& light;
  std::int64_t light_utime = 0;  ///< when its status was received
  std::int64_t bus_utime = 0;    ///< when the last message of another sender was received, 0: never
  bool ended = false;
  std::int64_t now = 0;

  [[nodiscard]] bool isLive() const { return !ended && !run_info.replay(); }
};

/// The advice, errors first.
[[nodiscard]] std::vector<Advice> adviceOn(const AdviceFacts& facts);

/// The entry "advice" of topic `health`.
[[nodiscard]] Json adviceJson(const std::vector<Advice>& advice);

}  // namespace lab::dashboard
