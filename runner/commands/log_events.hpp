/// The events of a log, for replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"

namespace lab::runner {

/// One event of a log, with its own copy of the data.
struct LogEvent {
  std::string channel;
  std::vector<std::uint8_t> data;
  std::int64_t utime = 0;  ///< when the logger received it, [us since 1970]
};

/// A part of a log.
struct LogSelection {
  double from = 0;                 ///< [s] since the first event
  std::optional<double> to;        ///< [s]
  std::set<std::string> channels;  ///< empty: all
};

/// EXPERIMENT_STATUS and EXPERIMENT_COMMAND: during a replay these are about the replay itself. The
/// recorded ones are not sent.
[[nodiscard]] bool isPlaybackChannel(std::string_view channel);

/// The selected events of a log series, sorted by time, without those of isPlaybackChannel().
[[nodiscard]] std::vector<LogEvent> selectEvents(const std::vector<std::filesystem::path>& files,
                                                 const LogSelection& selection);

/// The message as a replay sends it: messages with an origin get REPLAY, all others are unchanged.
[[nodiscard]] std::vector<std::uint8_t> asReplay(const std::string& channel, Bytes data);

/// The clock of a replay: log time against wall time, with pauses.
class ReplayClock {
 public:
  /// @param log_utime of the first event
  ReplayClock(std::int64_t log_utime, std::int64_t now, double speed)
      : log_anchor_(log_utime), wall_anchor_(now), speed_(speed) {}

  void pause(std::int64_t now);
  void resume(std::int64_t now);
  [[nodiscard]] bool paused() const { return paused_; }

  /// The time of the log at this time of the wall clock, both [us since 1970].
  [[nodiscard]] std::int64_t logTime(std::int64_t now) const;

 private:
  std::int64_t log_anchor_;
  std::int64_t wall_anchor_;
  double speed_;
  bool paused_ = false;
};

}  // namespace lab::runner
