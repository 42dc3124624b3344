/// Counts received and lost messages. Heartbeats, logs and reports show the counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

namespace lab {

/// One stream: the messages of one run (instance) of one sender on one channel. Several senders,
/// real and simulated, may share a channel.
struct StreamKey {
  std::string channel;
  std::string sender;
  std::int64_t instance = 0;
  auto operator<=>(const StreamKey&) const = default;
};

struct StreamCount {
  std::int64_t received = 0;
  std::int64_t lost = 0;  ///< from gaps in seq since the first received message
  std::int64_t first_seq = 0;
  std::int64_t last_seq = 0;
  std::int64_t last_utime = 0;    ///< of the message, [us since 1970]
  std::uint64_t recent = 1;       ///< bit i: last_seq - i was received
  std::int64_t last_counted = 0;  ///< number of its last message among all that were counted
};

/// Whether seq counts messages on this channel. A repeated command keeps its seq, which counts
/// orders, not messages.
[[nodiscard]] bool seqCountsMessages(std::string_view channel);

/// Counts received messages per stream, and lost ones from gaps in seq. A late message (at most 63
/// behind) reduces the lost count again; a duplicate does not.
class StreamCounter {
 public:
  /// A lab of many hosts has a hundred streams at one receiver. With this many, a heartbeat still
  /// fits into a message of 60 KB.
  static constexpr std::size_t kMostStreams = 256;
  /// A lab has 23 channels. A program may publish on any.
  static constexpr std::size_t kMostChannels = 100;

  /// @param most streams that are counted. A new one takes the place of a stream of few messages
  /// that has been silent for long, such as a command of the shell; where there is none, its
  /// messages are counted together with others.
  explicit StreamCounter(std::size_t most = kMostStreams) : most_(most) {}

  void count(std::string_view channel, std::string_view sender, std::int64_t instance,
             std::int64_t seq, std::int64_t utime);
  void countDecodeError(std::string_view channel, std::int64_t count = 1);

  [[nodiscard]] const std::map<StreamKey, StreamCount>& streams() const { return streams_; }
  [[nodiscard]] const std::map<std::string, std::int64_t>& decodeErrors() const {
    return decode_errors_;
  }
  /// Those on channels beyond the limit.
  [[nodiscard]] std::int64_t furtherDecodeErrors() const { return further_decode_errors_; }
  [[nodiscard]] std::int64_t lost() const;

  /// Messages of streams beyond the limit, which found no place.
  [[nodiscard]] std::int64_t uncounted() const { return uncounted_; }

 private:
  bool makePlace();

  std::size_t most_;
  std::int64_t counted_ = 0;
  std::map<StreamKey, StreamCount> streams_;
  std::map<std::string, std::int64_t> decode_errors_;
  std::int64_t further_decode_errors_ = 0;
  std::int64_t uncounted_ = 0;
  // The stream of the last message. Messages often come in sequences of one stream, and this saves
  // building a key for each.
  std::pair<const StreamKey, StreamCount>* last_ = nullptr;
};

}  // namespace lab
