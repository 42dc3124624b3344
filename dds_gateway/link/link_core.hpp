/// What passes between the buses of two hosts, and what does not. Numbers in, numbers out: no bus,
/// no DDS, no clock.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/bus/message_header.hpp"
#include "dds_gateway/link/lru_map.hpp"

namespace lab::gateway {

/// A packet of our bus that is passed on.
struct Outgoing {
  std::int32_t stream = 0;  ///< of this gateway's, from 1; channel, sender and instance decide
  std::int64_t number = 0;  ///< in this stream, from 1
  std::int32_t slot = 0;    ///< below kMostStreams: of this stream until another one takes it
};

/// What becomes of a packet that another gateway sent.
enum class Verdict : std::int8_t {
  kDeliver,   ///< put it on our bus
  kForeign,   ///< not the lab's, or of a channel that is not passed
  kRepeated,  ///< came before
  kStale,     ///< a command that took too long
  kHistory,   ///< a measurement from before we listened: only states are kept for late joiners
  kClash,     ///< its sender is at home here or on a third host
};

/// Of one other gateway, since it started.
struct LinkCounts {
  std::int64_t received = 0;  ///< delivered
  std::int64_t lost = 0;
  std::int64_t repeated = 0;
  std::int64_t stale = 0;
  std::int64_t clashing = 0;
};

/// Every message is passed on by one gateway only, that of the bus on which it was first heard. The
/// home of its sender (sender, instance) is learned at first sight; what came through the link is
/// heard again on our bus, once, and goes no further. Within a stream numbers rise: what repeats is
/// dropped, what is missing is counted.
///
/// Two gateways on one bus must not send packets in circles: a sender that is heard more often than
/// we put it there is at home here. A home here is given up when the sender has not been heard here
/// for a while and comes from elsewhere, after a time that differs from gateway to gateway: one of
/// the two brings it then, and the other hears that.
class LinkCore {
 public:
  /// A command that is older is not carried out [us].
  static constexpr std::int64_t kFreshCommand = 1'000'000;
  /// Of a bus. A busy lab has a hundred; those that are quiet for the longest are forgotten.
  static constexpr std::size_t kMostStreams = 1000;
  /// A sender that was not heard here for one to two of these may be at home elsewhere [us].
  static constexpr std::int64_t kHomeTimeout = 2'000'000;

  /// @param gateway ours, any number that differs from gateway to gateway
  explicit LinkCore(std::int64_t gateway)
      : home_holds_(kHomeTimeout + (gateway % kHomeTimeout + kHomeTimeout) % kHomeTimeout) {}

  /// A packet of our own bus, ours and those we put there included.
  /// @param now [us] of a clock that does not jump
  /// @return nothing when it is not passed on.
  [[nodiscard]] std::optional<Outgoing> hear(std::int64_t now, std::string_view channel,
                                             Bytes data);

  /// A packet of another gateway.
  /// @param host, gateway of the one that sent it, and when that one was started (any number that
  ///   differs from start to start)
  /// @param age [us] since it was heard there, by one clock
  [[nodiscard]] Verdict receive(std::int64_t now, const std::string& host, std::int64_t gateway,
                                std::int32_t stream, std::int64_t number, std::int64_t age,
                                std::string_view channel, Bytes data);

  /// Whether it passes even where nothing else does. The release of a stop is no stop.
  [[nodiscard]] static bool isStop(std::string_view channel, Bytes data);

  /// Packets on our bus or from others that are none of the lab's.
  [[nodiscard]] std::int64_t foreign() const { return foreign_; }
  /// Of this start of that host's gateway.
  [[nodiscard]] LinkCounts counts(const std::string& host) const;
  /// Everything that is kept, for tests of its bounds.
  [[nodiscard]] std::size_t size() const;

 private:
  struct Sender {
    std::string name;
    std::int64_t instance;
    auto operator<=>(const Sender&) const = default;
  };
  struct Home {
    std::string host;          ///< empty: here
    std::int64_t heard;        ///< there, or from there [us]
    std::int64_t brought = 0;  ///< put on our bus and not heard there yet
  };
  using StreamName = std::tuple<std::string, std::string, std::int64_t>;
  struct Sent {
    std::int32_t slot = 0;
    std::int32_t stream = 0;
    std::int64_t number = 0;
  };
  struct From {
    std::int64_t gateway = 0;
    LinkCounts counts;
    // Twice what the sender keeps: none of those it keeps is ever forgotten here.
    LruMap<std::int32_t, std::int64_t> last{2 * kMostStreams};  ///< number of each stream
  };
  static constexpr std::size_t kMostSenders = 4 * kMostStreams;
  static constexpr std::size_t kMostHosts = 100;

  /// Whether it is our own bus that this sender, just heard there, is at home on.
  bool isAtHome(std::int64_t now, const MessageHeader& header);
  /// @return of this sender, just heard from there; nullptr when it is at home elsewhere.
  Home* homeOn(const std::string& host, std::int64_t now, const MessageHeader& header);

  std::int64_t home_holds_;
  LruMap<Sender, Home> homes_{kMostSenders};
  LruMap<StreamName, Sent> sent_{kMostStreams};
  std::map<std::string, From> hosts_;
  std::int32_t streams_ = 0;
  std::int64_t foreign_ = 0;
};

}  // namespace lab::gateway
