/// Detects processes that run but are silent. No bus, no file.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lab::runner {

/// Expects a heartbeat of each process about once per second. Time counts only while look() is
/// called regularly: when this process was not scheduled or was stopped, the others are not to
/// blame.
class HeartbeatMonitor {
 public:
  /// Three missed heartbeats, and half a second of delay.
  static constexpr std::int64_t kTimeout_us = 3'500'000;
  /// Timeout after a start: a process may open a camera or a display first.
  static constexpr std::int64_t kStartTimeout_us = 10'000'000;
  /// Longest time between calls of look() that counts in full.
  static constexpr std::int64_t kLongestStep_us = 200'000;

  struct Change {
    std::string name;
    bool silent = false;         ///< false: heard of again
    std::int64_t silence_s = 0;  ///< [s] of silence so far
  };

  /// A process was started. It replaces an earlier one of that name.
  void expect(const std::string& name, std::int64_t timeout_us = kStartTimeout_us) {
    heartbeats_[name] = {.heard_us = clock_us_, .timeout_us = timeout_us};
  }

  /// The process is known to be dead: its silence is no news.
  void forget(const std::string& name) { heartbeats_.erase(name); }

  /// A heartbeat. Processes that are not expected are ignored.
  void beat(const std::string& name);

  /// @return the processes that became silent, or were heard again, since the last call
  [[nodiscard]] std::vector<Change> look(std::int64_t now);

 private:
  struct Heartbeat {
    std::int64_t heard_us = 0;  ///< on clock_us_
    std::int64_t timeout_us = 0;
    bool silent = false;
  };

  std::map<std::string, Heartbeat> heartbeats_;
  std::vector<Change> again_;
  std::int64_t clock_us_ = 0;
  std::int64_t looked_utime_ = 0;  ///< last call of look(), 0: none
};

}  // namespace lab::runner
