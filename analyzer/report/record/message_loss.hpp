/// What the log holds of what was sent: house rule 4 for a closed log.
#pragma once

#include <cstdint>
#include <lab/service_status_t.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/message_header.hpp"

namespace lab::report {

/// One channel of one start of one sender.
struct StreamLoss {
  std::string channel;
  std::string sender;
  int start = 1;              ///< counts the sender's starts from 1, in the order of the log
  std::int64_t received = 0;  ///< messages in the log
  std::int64_t lost = 0;      ///< sent since the log began and not in it
  bool at_least = false;      ///< the sender's final counts are missing: more may have been lost
  double largest_age = 0;     ///< [s] from the message's utime to its arrival at the logger
};

/// Over all streams. The lab's onlooker may die at any time and nothing of the run is missing:
/// at_least is about the others.
struct LossTotal {
  std::int64_t received = 0;
  std::int64_t lost = 0;
  bool at_least = false;
};
[[nodiscard]] LossTotal totalOf(const std::vector<StreamLoss>& streams);

/// Compares what senders say they sent with what is in the log.
///
/// A sender that started after the log began must have all of its messages in it. One that was
/// there before is counted from its first message that can be in the log. The counts of a clean
/// stop are final, and each of the closing messages carries them, so that any one is enough.
class MessageLossCounter {
 public:
  /// Counts a message. Every message must come here, SERVICE_STATUS before take().
  void count(std::string_view channel, const MessageHeader& header, std::int64_t received_utime);

  void take(const service_status_t& status);

  /// In the order of sender, start and channel.
  [[nodiscard]] std::vector<StreamLoss> streams() const;

  /// Which start of its sender this instance is, from 1; 0 when it was never heard.
  [[nodiscard]] int startOf(std::string_view sender, std::int64_t instance) const;

 private:
  struct Stream {
    std::string channel;
    std::int64_t received = 0;
    std::int64_t first_seq = 0;
    std::int64_t last_seq = 0;
    std::int64_t sent_first = 0;      ///< as the first status in the log says
    std::int64_t received_first = 0;  ///< until then
    std::int64_t sent_last = 0;       ///< as the last status in the log says
    std::int64_t largest_age_us = 0;
  };
  struct Sender {
    std::string name;
    std::int64_t instance = 0;
    std::int64_t start_utime = 0;
    bool has_status = false;
    bool ended = false;
    std::vector<Stream> streams;

    Stream& stream(std::string_view channel);
  };

  Sender& sender(std::string_view name, std::int64_t instance);
  [[nodiscard]] StreamLoss loss(const Sender& sender, const Stream& stream) const;

  std::vector<Sender> senders_;
  std::int64_t first_utime_ = 0;  ///< first arrival in the log
};

}  // namespace lab::report
