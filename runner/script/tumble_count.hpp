/// Tumbles of all robots, from counters that wrap and that begin anew when a robot reboots.
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

  /// Since the first status of each robot.
  /// @param robot 0: all together
  [[nodiscard]] std::int64_t total(std::int32_t robot) const {
    if (robot != 0) {
      const auto counter = robots_.find(robot);
      return counter == robots_.end() ? 0 : counter->second.total;
    }
    std::int64_t sum = 0;
    for (const auto& [id, counter] : robots_) sum += counter.total;
    return sum;
  }

  /// When the last tumble was counted [us since 1970], 0: none was.
  [[nodiscard]] std::int64_t lastUtime() const { return last_utime_; }

 private:
  struct Counter {
    std::int64_t utime = 0;
    std::uint32_t count = 0;
    std::int64_t total = 0;
  };

  /// No robot tumbles so often between two of its messages: a larger step is a reboot.
  static constexpr std::uint32_t kMostAtOnce = 100'000;

  void take(const robot_state_t& robot) {
    const auto now = static_cast<std::uint32_t>(robot.tumble_count);
    const auto [entry, is_new] = robots_.try_emplace(robot.robot_id, robot.utime, now);
    Counter& counter = entry->second;
    if (is_new || robot.utime <= counter.utime) return;
    std::uint32_t more = now - counter.count;  // modulo 2^32, across a wrap too
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
