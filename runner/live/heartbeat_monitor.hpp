/// Who has fallen silent without having ended: no bus, no file.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lab::runner {

/// Knows processes by signs of life that come about once a second. Its clock stands while it is not
/// looked at: where the one who looks was not scheduled, or was halted, nobody else was silent.
class HeartbeatMonitor {
 public:
  /// Three signs of life, and what the fourth may be late.
  static constexpr std::int64_t kPatience_us = 3'500'000;
  /// A process that starts may open a camera or a display first.
  static constexpr std::int64_t kStartPatience_us = 10'000'000;
  /// It is to be looked at at least so often.
  static constexpr std::int64_t kLongestStep_us = 200'000;

  struct Change {
    std::string name;
    bool silent = false;         ///< or heard of again
    std::int64_t silence_s = 0;  ///< [s] so far, whole ones
  };

  /// A process that has just been started, in place of any of that name.
  void expect(const std::string& name, std::int64_t patience_us = kStartPatience_us) {
    heartbeats_[name] = {.heard_us = clock_us_, .patience_us = patience_us};
  }

  /// A sign of life; of those that are not expected nothing is noted.
  void beat(const std::string& name);

  /// @return who has fallen silent or has been heard of again since the last look, each once
  [[nodiscard]] std::vector<Change> look(std::int64_t now);

 private:
  struct Heartbeat {
    std::int64_t heard_us = 0;  ///< on our clock
    std::int64_t patience_us = 0;
    bool silent = false;
  };

  std::map<std::string, Heartbeat> heartbeats_;
  std::vector<Change> again_;
  std::int64_t clock_us_ = 0;
  std::int64_t looked_utime_ = 0;  ///< 0: not yet
};

}  // namespace lab::runner
