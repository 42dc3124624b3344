/// Refuses messages of one channel whose time jumps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

/// Compares the time of each message with that of an earlier one: the last accepted message of the
/// same sender and instance, or, if there is none, of the channel. The message is accepted if
///
/// - the two times differ by at most kWindow_us, or
/// - their difference equals the time between the two arrivals, to within kWindow_us.
///
/// The first message of a channel is always accepted.
///
/// The clock of a sender may change: the sender restarts after its clock was set, or a replay
/// jumps. Therefore the new time is accepted with the kAgreeing-th message in a row that would be
/// refused, if these messages agree with each other by the same rule.
///
/// At most 64 streams (a sender and its instance) are kept. A message of a further sender is
/// compared with the last accepted message of the channel. Such a sender cannot introduce a new
/// time.
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

/// Whether the utime of this channel's messages advances as the receiver's clock does. It does so
/// for measurements. A command that is repeated keeps the time of its decision; an event has the
/// time of what it reports.
[[nodiscard]] bool timesFollowClock(std::string_view channel);

}  // namespace lab
