/// A log on a deck, as a film: play, pause, go elsewhere. No bus, no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <vector>

#include "runner/commands/log_events.hpp"

namespace lab::runner {

/// What happens at the end of a log.
enum class AtEnd {
  kEnd,    ///< the replay is over
  kPause,  ///< it stands there, paused
  kLoop,   ///< it begins anew
};

/// Times of the wall clock are us since 1970, as `now`.
class LogPlayback {
 public:
  using Send = std::function<void(const LogEvent&)>;

  static constexpr std::size_t kMostAtOnce = 2000;

  /// @param events in order of time, at least one; must outlive the deck
  /// @param run its name, for the status
  /// @param speed log seconds a second
  LogPlayback(const std::vector<LogEvent>& events, std::string run, double speed, AtEnd at_end,
              std::int64_t now);

  /// Does what PAUSE, RESUME, SEEK, SPEED or END wishes. Any other wish is refused: nobody is
  /// there.
  /// @return why it is refused, empty: it is done
  [[nodiscard]] std::string obey(const experiment_command_t& wish, std::int64_t now);

  void pauseOrResume(std::int64_t now);

  /// Sees to the end of the log. To be called before play().
  /// @return whether the status is another one now
  bool advance(std::int64_t now);

  /// Sends what has become due. After a jump that is first every EXPERIMENT_EVENT from the log's
  /// begin to the new place, once, and everything of the two seconds before it. At most
  /// kMostAtOnce messages a call, so that whoever plays a full log hears wishes in between.
  void play(std::int64_t now, const Send& send);

  /// The replay has been ended, or is over.
  [[nodiscard]] bool over() const { return over_; }

  [[nodiscard]] bool paused() const { return clock_.paused(); }
  [[nodiscard]] double rate() const { return paused() ? 0 : speed_; }

  /// Where it is, [us since 1970], within the log.
  [[nodiscard]] std::int64_t logTime(std::int64_t now) const;
  [[nodiscard]] double elapsed(std::int64_t now) const;  ///< [s] since the first event
  [[nodiscard]] double length() const;                   ///< [s]
  [[nodiscard]] std::size_t sent() const { return next_; }

  /// EXPERIMENT_STATUS without its header and without a command's answer.
  [[nodiscard]] experiment_status_t status(std::int64_t now) const;

 private:
  void jumpTo(std::int64_t log_utime, std::int64_t now);
  std::string resume(std::int64_t now);
  std::string seek(double to, std::int64_t now);
  std::string setSpeed(double speed, std::int64_t now);
  [[nodiscard]] std::size_t firstAt(std::int64_t log_utime) const;

  const std::vector<LogEvent>& events_;
  std::string run_;
  double speed_;
  AtEnd at_end_;
  ReplayClock clock_;
  std::vector<std::size_t> event_indices_;  ///< of EXPERIMENT_EVENT, each once
  std::size_t next_ = 0;
  bool jumped_ = false;               ///< what is before next_ has still to be sent
  std::deque<std::size_t> catch_up_;  ///< of that, what is left
  std::int32_t jumps_ = 0;
  bool over_ = false;
};

}  // namespace lab::runner
