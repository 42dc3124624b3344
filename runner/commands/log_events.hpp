/// The events of a log, for replay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/logged_messages.hpp"

namespace lab::runner {

/// One event of a log. Its message stays in the file.
struct LogEvent {
  std::int64_t utime = 0;      ///< when the replay sends it, as time of the log with shortened gaps
  std::int64_t log_utime = 0;  ///< when the logger received it, [us since 1970]
  std::uint64_t offset = 0;    ///< of the message in its file
  std::uint32_t size = 0;      ///< of the message
  std::uint32_t file = 0;      ///< index
  std::uint32_t channel = 0;   ///< index
};

/// A part of a log.
struct LogSelection {
  double from = 0;                              ///< [s] since the first event
  std::optional<double> to;                     ///< [s]
  std::set<std::string, std::less<>> channels;  ///< empty: all
  double max_gap = 10;  ///< [s] a longer silence of the whole log is shortened to this
};

/// What the replay does not play as it was recorded.
struct ShortenedGaps {
  std::int64_t gaps = 0;        ///< silences that were shortened
  double longest = 0;           ///< [s] of these, as recorded
  std::int64_t steps_back = 0;  ///< steps back of the logger's clock, played without a pause
};

/// EXPERIMENT_STATUS and EXPERIMENT_COMMAND: during a replay these are about the replay itself. The
/// recorded ones are not sent.
[[nodiscard]] bool isPlaybackChannel(std::string_view channel);

/// The selected events of a log series, sorted by time, without those of isPlaybackChannel() and
/// those that no bus carries. They take 40 bytes each, however long the messages are: a log may be
/// larger than the memory.
class LogEvents {
 public:
  /// @throws std::runtime_error if a file cannot be opened or read
  explicit LogEvents(const std::vector<std::filesystem::path>& files,
                     const LogSelection& selection = {});

  [[nodiscard]] const std::vector<LogEvent>& all() const { return events_; }
  [[nodiscard]] const std::string& channelOf(const LogEvent& event) const {
    return channels_[event.channel];
  }
  /// Whether there is an event on the channel.
  [[nodiscard]] bool has(std::string_view channel) const { return indices_.contains(channel); }
  /// @return valid until the next call
  /// @throws std::runtime_error if the file has become shorter, or cannot be read
  [[nodiscard]] Bytes messageOf(const LogEvent& event) {
    return messages_.at({event.file, event.offset, event.size});
  }
  /// What was shortened in the whole log.
  [[nodiscard]] const ShortenedGaps& gaps() const { return gaps_; }
  /// Of the whole log, with shortened gaps [s].
  [[nodiscard]] double logLength() const { return length_; }
  /// Of the whole log, without those of isPlaybackChannel(); the first hundred in alphabetical
  /// order.
  [[nodiscard]] const std::set<std::string, std::less<>>& logChannels() const { return found_; }
  /// Whether the log has a message on a selected channel, at any time.
  [[nodiscard]] bool hasSelectedChannel() const { return has_selected_; }
  /// The number of selected events with a channel name or a message that is too long for a bus.
  [[nodiscard]] std::int64_t unsendable() const { return unsendable_; }

 private:
  void noteChannel(std::string_view channel);
  std::uint32_t indexOf(std::string_view channel);

  LoggedMessages messages_;
  std::vector<LogEvent> events_;
  std::vector<std::string> channels_;
  std::map<std::string, std::uint32_t, std::less<>> indices_;  ///< of channels_
  ShortenedGaps gaps_;
  double length_ = 0;
  std::set<std::string, std::less<>> found_;
  bool has_selected_ = false;
  std::int64_t unsendable_ = 0;
};

/// The message as a replay sends it: messages with an origin get REPLAY, all others are unchanged.
[[nodiscard]] std::vector<std::uint8_t> asReplay(std::string_view channel, Bytes data);

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
