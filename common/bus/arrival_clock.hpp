/// The order in time of the messages of one channel.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// Refuses messages whose time does not continue the messages before them.
///
/// A message is compared with the last one of its sender, and the first one of a sender with the
/// last one of the channel. Its time may differ from that by kWindow_us, or by kWindow_us from what
/// the receiver's own clock has advanced since. So a sender may be silent, a receiver may read its
/// queue late, and clocks may differ. A live service keeps its clock against steps of the wall
/// clock; one that starts after a step has another clock, as has a replay after a jump: after
/// kAgreeing messages of a sender in a row that continue each other, its new time is accepted.
/// Senders beyond a limit must keep the time of the channel.
class ArrivalClock {
 public:
  /// Far above the jitter of frames and packets, far below every silence that counts as one.
  static constexpr std::int64_t kWindow_us = 5'000'000;
  static constexpr int kAgreeing = 3;

  /// @param utime of the message
  /// @param now the receiver's clock, or that of the log, at the message's arrival
  /// All times are from 0 to ValueChecker::kLatestUtime.
  [[nodiscard]] bool accepts(std::string_view sender, std::int64_t instance, std::int64_t utime,
                             std::int64_t now);

 private:
  struct Moment {
    std::int64_t utime = 0;
    std::int64_t now = 0;
  };
  struct Stream {
    std::string sender;
    std::int64_t instance = 0;
    std::optional<Moment> last;   ///< last accepted
    std::optional<Moment> doubt;  ///< last refused, while it may be a new time
    int agreeing = 0;             ///< refused in a row that continue each other
  };

  static bool continues(const Moment& before, const Moment& after);
  Stream* streamOf(std::string_view sender, std::int64_t instance);  ///< nullptr: too many

  std::vector<Stream> streams_;
  std::optional<Moment> last_;  ///< last accepted of any sender
};

/// Whether utime is the time of a measurement, which passes as the receiver's clock does. Commands
/// keep the time of their decision while they are repeated, and events that of what they report.
[[nodiscard]] bool timesFollowClock(std::string_view channel);

}  // namespace lab
