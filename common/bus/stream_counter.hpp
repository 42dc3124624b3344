/// House rule 4: say what was lost.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

namespace lab {

/// One stream: a channel of one run of one sender. Real and simulated senders share channels.
struct StreamKey {
  std::string channel;
  std::string sender;
  std::int64_t instance = 0;
  auto operator<=>(const StreamKey&) const = default;
};

struct StreamCount {
  std::int64_t received = 0;
  std::int64_t lost = 0;  ///< by gaps in seq since the first message heard
  std::int64_t first_seq = 0;
  std::int64_t last_seq = 0;
  std::int64_t last_utime = 0;  ///< of the message, [us since 1970]
  std::uint64_t recent = 1;     ///< bit i: last_seq - i came
};

/// Commands repeat a seq while they repeat themselves: their seq counts orders, not messages.
[[nodiscard]] bool seqCountsMessages(std::string_view channel);

/// Counts per stream what came and, by gaps in seq, what did not. A late message (at most 63
/// behind) is a gap that closes again; one that comes twice closes nothing.
class StreamCounter {
 public:
  void count(std::string_view channel, std::string_view sender, std::int64_t instance,
             std::int64_t seq, std::int64_t utime);
  void countDecodeError(std::string_view channel) { ++decode_errors_[std::string(channel)]; }

  [[nodiscard]] const std::map<StreamKey, StreamCount>& streams() const { return streams_; }
  [[nodiscard]] const std::map<std::string, std::int64_t>& decodeErrors() const {
    return decode_errors_;
  }
  [[nodiscard]] std::int64_t lost() const;

 private:
  std::map<StreamKey, StreamCount> streams_;
  std::map<std::string, std::int64_t> decode_errors_;
  // The stream heard last: most messages come in runs, and this saves building a key for each.
  std::pair<const StreamKey, StreamCount>* last_ = nullptr;
};

}  // namespace lab
