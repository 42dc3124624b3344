/// When a process that died is started again.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace lab::runner {

/// Limits the restarts of one process. The first is immediate, because a run goes on only with it;
/// the pause before each further one doubles, as the cause may pass (a device that comes back). No
/// clock of its own.
class RestartLimit {
 public:
  /// Restarts within kWindow_us; one more death, and the process is given up.
  static constexpr std::size_t kMost = 5;
  /// A service that fails at every start does so within 10 s (HeartbeatMonitor::kStartTimeout_us,
  /// a camera or a display is opened first): with all pauses it reaches kMost in this time. One
  /// that crashes now and then in a run of hours is always restarted.
  static constexpr std::int64_t kWindow_us = 60'000'000;
  static constexpr std::int64_t kFirstPause_us = 500'000;

  /// The process died.
  /// @return when it may be started again; nothing: it dies too often
  [[nodiscard]] std::optional<std::int64_t> noteDeath(std::int64_t now);

 private:
  std::deque<std::int64_t> deaths_;  ///< within the window
};

/// "was restarted", "is restarted in 0.5 s"
[[nodiscard]] std::string restartText(std::int64_t pause_us);

/// "died too often (6 times in 60 s)"
[[nodiscard]] std::string tooOftenText();

}  // namespace lab::runner
