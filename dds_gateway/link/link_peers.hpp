/// The gateways of the other hosts: who lives, whose clock is right, who speaks our language. No
/// DDS, no bus, no clock.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dds_gateway/link/clock_offset.hpp"

namespace lab::gateway {

/// What a message of the lab looks like to a program.
struct ProtocolVersion {
  std::int32_t contract = 0;  ///< kContractVersion
  std::string fingerprints;   ///< of all types
  std::string version;        ///< of the software, for people

  /// Of this program.
  [[nodiscard]] static ProtocolVersion own();
  [[nodiscard]] bool fits(const ProtocolVersion& other) const {
    return contract == other.contract && fingerprints == other.fingerprints;
  }
};

/// A sign of life: a ping to all, or the answer (pong) to one of them.
struct LinkHeartbeat {
  std::string host;
  std::int64_t gateway = 0;  ///< new at each start
  ProtocolVersion edition;
  std::int64_t to = 0;        ///< the gateway whose ping this answers, 0: a ping
  std::int64_t sent = 0;      ///< the ping's, by the clock of who asked [us since 1970]
  std::int64_t there = 0;     ///< a pong's: when the ping came, by the clock of who answers
  std::int64_t answered = 0;  ///< a pong's: when it left
  std::string refusal;        ///< a pong's: why nothing passes, empty: it does
};

enum class PeerState : std::int8_t { kNew, kJoined, kSilent, kRefused };

struct LinkPeer {
  std::string host;
  std::int64_t gateway = 0;
  ProtocolVersion edition;
  PeerState state = PeerState::kNew;  ///< new: alive, its clock not known yet
  std::int64_t heard = 0;             ///< the last sign of life [us since 1970]
  std::int64_t met = 0;               ///< the first one
  std::int64_t double_heard = 0;      ///< the last sign of another gateway of this name
  std::string trouble;                ///< empty: all is well
  std::string refusal;                ///< why it refuses us, as it says
  ClockOffset clock;
  ClockOffsetEstimator round_trips;
};

class LinkPeers {
 public:
  /// Without a sign of life for so long a peer is silent [us].
  static constexpr std::int64_t kSilent = 1'000'000;
  static constexpr std::size_t kMostPeers = 64;

  /// @param most_offset [s] between two clocks
  LinkPeers(std::string host, std::int64_t gateway, ProtocolVersion edition, double most_offset);

  /// What to ask all others, a few times a second.
  [[nodiscard]] LinkHeartbeat ping(std::int64_t now) const;

  /// A sign of another gateway.
  /// @param answer what to send back, when the result says so
  /// @return whether there is an answer
  [[nodiscard]] bool hear(std::int64_t now, const LinkHeartbeat& sign, LinkHeartbeat& answer);

  /// Anything else that came from a peer: a sign of life, too.
  void alive(std::int64_t now, const std::string& host, std::int64_t gateway);

  /// Time passes; several times a second. @return whether a state has changed since the last call.
  [[nodiscard]] bool tick(std::int64_t now);

  /// @return nullptr for a gateway that is not known: it has not said which it is.
  [[nodiscard]] const LinkPeer* find(const std::string& host, std::int64_t gateway) const;
  [[nodiscard]] const std::map<std::string, LinkPeer>& all() const { return peers_; }

 private:
  LinkPeer* admit(std::int64_t now, const LinkHeartbeat& sign);
  void judge(std::int64_t now, LinkPeer& peer);
  [[nodiscard]] std::string refusalOf(const LinkPeer& peer) const;
  [[nodiscard]] std::string clockTrouble(const LinkPeer& peer) const;

  std::string host_;
  std::int64_t gateway_;
  ProtocolVersion edition_;
  double most_offset_;
  std::map<std::string, LinkPeer> peers_;  ///< by host
  std::int64_t ticked_ = 0;
  bool changed_ = false;
};

}  // namespace lab::gateway
