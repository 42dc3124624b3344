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
/// A message continues an earlier one if their times differ by at most kWindow_us, or if the
/// difference of their times is within kWindow_us of the time that passed on the receiver's clock.
/// The earlier one is the last accepted of the same sender and instance, or, before that has one,
/// of the channel. A message that does not continue it is refused.
///
/// A sender may have changed its clock (restart after a clock step, jump of a replay). After
/// kAgreeing refused messages of one sender in a row, each continuing the one before, the last is
/// accepted. The first message of a channel is accepted, too. At most 64 streams (sender and
/// instance) are tracked. Messages of further senders are compared with the channel's last accepted
/// one and move it if they are accepted, but they never start a new time.
class ArrivalClock {
 public:
  /// Far above the jitter of frames and packets.
  static constexpr std::int64_t kWindow_us = 5'000'000;
  static constexpr int kAgreeing = 3;

  /// All times are from 0 to ValueChecker::kLatestUtime.
  /// @param utime of the message
  /// @param now the receiver's clock, or that of the log, at the message's arrival
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
    std::optional<Moment> doubt;  ///< last refused; starts or continues a possible new time
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
