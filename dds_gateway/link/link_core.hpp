/// Decides which packets pass between the buses of two hosts. Without bus, DDS and clock.
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

/// A packet of our bus that is forwarded.
struct Outgoing {
  std::int32_t stream = 0;  ///< number of the stream (channel, sender, instance) here, from 1
  std::int64_t number = 0;  ///< of the packet in this stream, from 1
  std::int32_t slot = 0;    ///< below kMostStreams: of this stream until another one reuses it
};

/// Decision on a packet from another gateway.
enum class Verdict : std::int8_t {
  kDeliver,   ///< publish it on our bus
  kForeign,   ///< not a message of the lab, or of a channel that is not forwarded
  kRepeated,  ///< was received before
  kStale,     ///< a command that took too long
  kHistory,   ///< a measurement from before we joined: late joiners get only states
  kClash,     ///< its sender belongs to this host or to a third one
};

/// Counts for one other gateway, since its start.
struct LinkCounts {
  std::int64_t received = 0;  ///< delivered
  std::int64_t lost = 0;
  std::int64_t repeated = 0;
  std::int64_t stale = 0;
  std::int64_t clashing = 0;
};

/// Exactly one gateway forwards a message: that of the bus on which its sender (sender, instance)
/// was first received, the sender's home. A message from the link comes back once from our bus as
/// an echo and is not forwarded again. Numbers rise within a stream: repetitions are dropped, gaps
/// counted.
///
/// Two gateways on one bus must not send packets in circles. If a sender is received more often
/// than the link has published it here, its home is here. This home is given up if the sender has
/// not been received here for some time and comes from another host. The time differs between
/// gateways, so one of the two forwards the sender then, and the other one receives it.
class LinkCore {
 public:
  /// Maximal age of a command [us].
  static constexpr std::int64_t kFreshCommand = 1'000'000;
  /// Maximal number of streams of a bus. A busy lab has a hundred. The least recent are forgotten.
  static constexpr std::size_t kMostStreams = 1000;
  /// A sender that was silent here for one to two times this may change its home [us].
  static constexpr std::int64_t kHomeTimeout = 2'000'000;

  /// @param gateway of this host; any number that differs between gateways
  explicit LinkCore(std::int64_t gateway)
      : home_holds_(kHomeTimeout + (gateway % kHomeTimeout + kHomeTimeout) % kHomeTimeout) {}

  /// A packet from our own bus, including our own packets and those that the link published there.
  /// @param now [us] of a steady clock
  /// @return nothing if it is not forwarded
  [[nodiscard]] std::optional<Outgoing> hear(std::int64_t now, std::string_view channel,
                                             Bytes data);

  /// A packet from another gateway.
  /// @param host,gateway of the sending gateway; `gateway` is any number that differs between
  /// starts
  /// @param age [us] since it was received there, by one clock
  [[nodiscard]] Verdict receive(std::int64_t now, const std::string& host, std::int64_t gateway,
                                std::int32_t stream, std::int64_t number, std::int64_t age,
                                std::string_view channel, Bytes data);

  /// Whether the packet is a stop, which passes even between refused peers. The release of a stop
  /// is not a stop.
  [[nodiscard]] static bool isStop(std::string_view channel, Bytes data);

  /// Packets, from our bus or from others, that are not messages of the lab.
  [[nodiscard]] std::int64_t foreign() const { return foreign_; }
  /// Counts since the last start of that host's gateway.
  [[nodiscard]] LinkCounts counts(const std::string& host) const;
  /// Number of stored entries, for tests of its bounds.
  [[nodiscard]] std::size_t size() const;

 private:
  struct Sender {
    std::string name;
    std::int64_t instance;
    auto operator<=>(const Sender&) const = default;
  };
  struct Home {
    std::string host;          ///< empty: this host
    std::int64_t heard;        ///< time of the last message [us]
    std::int64_t brought = 0;  ///< published on our bus, whose echo has not come back yet
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
    // Twice the number that the sender stores, so no stored stream is forgotten here.
    LruMap<std::int32_t, std::int64_t> last{2 * kMostStreams};  ///< number of each stream
  };
  static constexpr std::size_t kMostSenders = 4 * kMostStreams;
  static constexpr std::size_t kMostHosts = 100;

  /// Whether a sender that was just received from our own bus has its home here.
  bool isAtHome(std::int64_t now, const MessageHeader& header);
  /// @return the home of a sender that was just received from `host`; nullptr if it has another
  /// home
  Home* homeOn(const std::string& host, std::int64_t now, const MessageHeader& header);

  std::int64_t home_holds_;
  LruMap<Sender, Home> homes_{kMostSenders};
  LruMap<StreamName, Sent> sent_{kMostStreams};
  std::map<std::string, From> hosts_;
  std::int32_t streams_ = 0;
  std::int64_t foreign_ = 0;
};

}  // namespace lab::gateway
