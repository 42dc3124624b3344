/// State of the gateways of the other hosts: whether they answer, their clock, their version.
/// Without DDS, bus and clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/math/clock_offset.hpp"

namespace lab::gateway {

/// Version of the messages of a program.
struct ProtocolVersion {
  std::int32_t contract = 0;  ///< kContractVersion
  std::string fingerprints;   ///< of all types
  std::string version;        ///< of the software, for display

  /// Of this program.
  [[nodiscard]] static ProtocolVersion own();
  [[nodiscard]] bool fits(const ProtocolVersion& other) const {
    return contract == other.contract && fingerprints == other.fingerprints;
  }
};

/// A heartbeat: a ping to all gateways, or the answer (pong) to one.
struct LinkHeartbeat {
  std::string host;
  std::int64_t gateway = 0;  ///< new at each start
  ProtocolVersion protocol;
  std::int64_t to = 0;     ///< the gateway whose ping this answers, 0: a ping
  std::int64_t sent = 0;   ///< time of the ping, by the clock of its sender [us since 1970]
  std::int64_t there = 0;  ///< of a pong: arrival of the ping, by the clock of the answering host
  std::int64_t answered = 0;  ///< of a pong: when it left
  std::string refusal;        ///< of a pong: why messages are refused; empty: they pass

  static constexpr std::size_t kLongestName = 64;  ///< [byte] of host, fingerprints and version
  static constexpr std::size_t kLongestRefusal = 1000;  ///< [byte]
  /// Whether all texts are within these limits. They are stored, and repeated each second.
  [[nodiscard]] bool hasShortTexts() const;
};

enum class PeerState : std::int8_t { kNew, kJoined, kSilent, kRefused };

struct LinkPeer {
  std::string host;
  std::int64_t gateway = 0;
  ProtocolVersion protocol;
  PeerState state = PeerState::kNew;  ///< new: it answers, its clock is not known yet
  std::int64_t heard = 0;             ///< the last heartbeat or packet [us since 1970]
  std::int64_t met = 0;               ///< the first one
  std::int64_t double_heard = 0;      ///< the last heartbeat of another gateway of this name
  std::string trouble;                ///< the problem and what to do; empty: none
  std::string refusal;                ///< why it refuses us, as it reports
  ClockOffset clock;
  ClockOffsetEstimator round_trips;
};

/// The state of a peer for a log: one line, in which control characters of its texts are shown as
/// text.
[[nodiscard]] std::string stateText(const LinkPeer& peer);

class LinkPeers {
 public:
  /// A peer without a heartbeat or packet for this time is silent [us].
  static constexpr std::int64_t kSilent = 1'000'000;
  static constexpr std::size_t kMostPeers = 64;

  /// @param max_offset [s] between two clocks
  LinkPeers(std::string host, std::int64_t gateway, ProtocolVersion protocol, double max_offset);

  /// The ping to send to all others, a few times a second.
  [[nodiscard]] LinkHeartbeat ping(std::int64_t now) const;

  /// A heartbeat of another gateway. One with longer texts than allowed is ignored.
  /// @param answer the pong to send, if the result is true
  /// @return whether there is an answer
  [[nodiscard]] bool hear(std::int64_t now, const LinkHeartbeat& heartbeat, LinkHeartbeat& answer);

  /// A packet from a peer, which also shows that it is alive.
  void alive(std::int64_t now, const std::string& host, std::int64_t gateway);

  /// Updates all states; call it several times a second. @return whether a state has changed since
  /// the last call
  [[nodiscard]] bool tick(std::int64_t now);

  /// @return nullptr for a gateway that has not sent a heartbeat
  [[nodiscard]] const LinkPeer* find(const std::string& host, std::int64_t gateway) const;
  [[nodiscard]] const std::map<std::string, LinkPeer>& all() const { return peers_; }

 private:
  LinkPeer* admit(std::int64_t now, const LinkHeartbeat& heartbeat);
  void updateState(std::int64_t now, LinkPeer& peer);
  [[nodiscard]] std::string refusalOf(const LinkPeer& peer) const;
  [[nodiscard]] std::string clockTrouble(const LinkPeer& peer) const;

  std::string host_;
  std::int64_t gateway_;
  ProtocolVersion protocol_;
  double max_offset_;
  std::map<std::string, LinkPeer> peers_;  ///< by host
  std::int64_t ticked_ = 0;
  bool changed_ = false;
};

}  // namespace lab::gateway
