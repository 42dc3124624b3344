/// Counts the tumbles of all robots from their 32-bit counters, which wrap and restart at a reboot.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <map>

namespace lab::runner {

class TumbleCount {
 public:
  void take(const robot_status_t& status) {
    for (const robot_state_t& robot : status.robots) take(robot);
  }

  /// Tumbles since the first status of each robot.
  /// @param robot id, or 0 for the sum over all robots
  [[nodiscard]] std::int64_t total(std::int32_t robot) const {
    if (robot != 0) {
      const auto counter = robots_.find(robot);
      return counter == robots_.end() ? 0 : counter->second.total;
    }
    std::int64_t sum = 0;
    for (const auto& [id, counter] : robots_) sum += counter.total;
    return sum;
  }

  /// Time of the last tumble [us since 1970]; 0 if there was none.
  [[nodiscard]] std::int64_t lastUtime() const { return last_utime_; }

 private:
  struct Counter {
    std::int64_t utime = 0;
    std::uint32_t count = 0;
    std::int64_t total = 0;
  };

  /// No robot tumbles this often between two messages; a larger step means a reboot.
  static constexpr std::uint32_t kMostAtOnce = 100'000;

  void take(const robot_state_t& robot) {
    const auto now = static_cast<std::uint32_t>(robot.tumble_count);
    const auto [entry, is_new] = robots_.try_emplace(robot.robot_id, Counter{robot.utime, now});
    Counter& counter = entry->second;
    if (is_new || robot.utime <= counter.utime) return;
    std::uint32_t more = now - counter.count;  // modulo 2^32, so a wrap is handled
    if (more > kMostAtOnce) more = now > kMostAtOnce ? 0 : now;
    counter.utime = robot.utime;
    counter.count = now;
    counter.total += more;
    if (more > 0) last_utime_ = robot.utime;
  }

  std::map<std::int32_t, Counter> robots_;
  std::int64_t last_utime_ = 0;
};

}  // namespace lab::runner
