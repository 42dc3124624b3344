/// Counts the messages that were sent and are missing in a closed log.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/service_status_t.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/message_header.hpp"

namespace lab::report {

/// The messages of one channel from one start of one sender.
struct StreamLoss {
  std::string channel;
  std::string sender;
  int start = 1;              ///< number of the start of the sender, from 1
  std::int64_t received = 0;  ///< messages in the log
  std::int64_t lost = 0;      ///< sent after the beginning of the log and missing in it
  bool at_least = false;      ///< the final counts of the sender are missing, so more may be lost
  double largest_age = 0;     ///< [s] from the message's utime to its arrival at the logger
};

/// Sums over all streams. The dashboard only observes and may be killed at any time, so it does not
/// set at_least.
struct LossTotal {
  std::int64_t received = 0;
  std::int64_t lost = 0;
  bool at_least = false;
};
[[nodiscard]] LossTotal totalOf(const std::vector<StreamLoss>& streams);

/// Compares the counts that senders report with the messages in the log.
///
/// All messages of a sender that started after the beginning of the log must be in it. For an
/// earlier sender, counting begins with its first message that can be in the log. After a clean
/// stop the counts are final; every closing message has them, so one is sufficient.
class MessageLossCounter {
 public:
  /// Counts a message. Call it for every message; for SERVICE_STATUS before take().
  void count(std::string_view channel, const MessageHeader& header, std::int64_t received_utime);

  void take(const service_status_t& status);

  /// Ordered by sender, start and channel.
  [[nodiscard]] std::vector<StreamLoss> streams() const;

  /// The number of the start with this instance, from 1; 0 if it is unknown.
  [[nodiscard]] int startOf(std::string_view sender, std::int64_t instance) const;

  /// Messages of senders beyond the limit, which are not counted by stream.
  [[nodiscard]] std::int64_t uncounted() const { return uncounted_; }

  /// A lab of many hosts has a hundred starts of senders.
  static constexpr std::size_t kMostSenders = 500;

 private:
  struct Stream {
    std::string channel;
    std::int64_t received = 0;
    std::int64_t first_seq = 0;
    std::int64_t last_seq = 0;
    std::int64_t sent_first = 0;      ///< count in the first status in the log
    std::int64_t received_first = 0;  ///< received before that
    std::int64_t sent_last = 0;       ///< count in the last status in the log
    std::int64_t largest_age_us = 0;
    std::int64_t numbered = 0;  ///< messages whose seq counts
    std::optional<std::int64_t>
        doubt{};  ///< a seq far from the last one, until the next confirms it

    void take(std::int64_t seq);
  };
  struct Sender {
    std::string name;
    std::int64_t instance = 0;
    std::int64_t start_utime = 0;
    bool has_status = false;
    bool ended = false;
    std::vector<Stream> streams;

    Stream* stream(std::string_view channel);  ///< nullptr: beyond the limit
  };

  Sender* sender(std::string_view name, std::int64_t instance);  ///< nullptr: beyond the limit
  [[nodiscard]] StreamLoss loss(const Sender& sender, const Stream& stream) const;

  std::vector<Sender> senders_;
  std::int64_t first_utime_ = 0;  ///< first arrival in the log
  std::int64_t uncounted_ = 0;
};

}  // namespace lab::report
