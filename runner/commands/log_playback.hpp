/// Playback of a log: play, pause, seek. No bus, no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "runner/commands/log_events.hpp"

namespace lab::runner {

/// What a replay does at the end of the log.
enum class AtEnd {
  kEnd,    ///< the replay is over
  kPause,  ///< it pauses there
  kLoop,   ///< it starts again
};

/// `now` is the wall clock [us since 1970].
class LogPlayback {
 public:
  using Send = std::function<void(std::string_view channel, Bytes message)>;

  static constexpr std::size_t kMostAtOnce = 2000;

  /// @param log at least one event; must outlive this object
  /// @param run its name, for the status
  /// @param speed log seconds a second
  LogPlayback(LogEvents& log, std::string run, double speed, AtEnd at_end, std::int64_t now);

  /// Executes PAUSE, RESUME, SEEK, SPEED and END. Other commands are refused: there is no lab.
  /// @return why it is refused; empty: executed
  [[nodiscard]] std::string execute(const experiment_command_t& command, std::int64_t now);

  void pauseOrResume(std::int64_t now);

  /// Handles the end of the log. Call before play().
  /// @return whether the status has changed
  bool advance(std::int64_t now);

  /// Sends the events that are due. After a seek, first sends each EXPERIMENT_EVENT from the begin
  /// of the log to the new time once, and all messages of the two seconds before it. Sends at most
  /// kMostAtOnce messages per call, so that the caller receives commands in between.
  /// @throws std::runtime_error if the log cannot be read any more
  void play(std::int64_t now, const Send& send);

  /// Whether the replay was ended or has reached its end.
  [[nodiscard]] bool over() const { return over_; }

  [[nodiscard]] bool paused() const { return clock_.paused(); }
  [[nodiscard]] double rate() const { return paused() ? 0 : speed_; }

  /// The current time in the log with shortened gaps [us since 1970].
  [[nodiscard]] std::int64_t logTime(std::int64_t now) const;
  /// The same as it was recorded, for CLOCK: the time of the messages that are sent now.
  [[nodiscard]] std::int64_t recordedTime(std::int64_t now) const;
  [[nodiscard]] double elapsed(std::int64_t now) const;  ///< [s] since the first event
  [[nodiscard]] double length() const;                   ///< [s]
  [[nodiscard]] std::size_t sent() const { return next_; }

  /// EXPERIMENT_STATUS without its header and without answers to commands.
  [[nodiscard]] experiment_status_t status(std::int64_t now) const;

 private:
  void jumpTo(std::int64_t log_utime, std::int64_t now);
  std::string resume(std::int64_t now);
  std::string seek(double to, std::int64_t now);
  std::string setSpeed(double speed, std::int64_t now);
  [[nodiscard]] std::size_t firstAt(std::int64_t log_utime) const;
  void sendEvent(std::size_t index, const Send& send);

  LogEvents& log_;
  const std::vector<LogEvent>& events_;  ///< of log_
  std::string run_;
  double speed_;
  AtEnd at_end_;
  ReplayClock clock_;
  std::vector<std::size_t> event_indices_;  ///< of EXPERIMENT_EVENT, each once
  std::size_t next_ = 0;
  bool jumped_ = false;               ///< events before next_ must still be sent
  std::deque<std::size_t> catch_up_;  ///< indices of these
  std::int32_t jumps_ = 0;
  bool over_ = false;
};

}  // namespace lab::runner
