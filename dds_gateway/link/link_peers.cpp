#include "dds_gateway/link/link_peers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/bus/fingerprints.hpp"
#include "common/process/version.hpp"
#include "common/text/fnv1a.hpp"
#include "common/text/printable.hpp"

namespace lab::gateway {
namespace {

/// A refused clock is accepted again below this share of the limit: hysteresis.
constexpr double kBetterThanNeeded = 0.9;
/// Without an answer for this time the way back is considered closed [us].
constexpr std::int64_t kNoAnswer = 3'000'000;

std::string digest(const std::string& text) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx",
                static_cast<unsigned long long>(fnv1a(text)));
  return digits.data();
}

std::string asText(double seconds) {
  std::array<char, 400> text{};
  if (seconds < 1) {
    std::snprintf(text.data(), text.size(), "%.3g ms", seconds * 1e3);
  } else {
    std::snprintf(text.data(), text.size(), "%.1f s", seconds);
  }
  return text.data();
}

std::string asText(const ProtocolVersion& protocol) {
  return "message contract " + std::to_string(protocol.contract) + " (types " +
         protocol.fingerprints + ", version " + protocol.version + ")";
}

}  // namespace

ProtocolVersion ProtocolVersion::own() {
  return {kContractVersion, digest(fingerprintList()), kVersion};
}

bool LinkHeartbeat::hasShortTexts() const {
  return host.size() <= kLongestName && protocol.fingerprints.size() <= kLongestName &&
         protocol.version.size() <= kLongestName && refusal.size() <= kLongestRefusal;
}

std::string stateText(const LinkPeer& peer) {
  switch (peer.state) {
    case PeerState::kJoined:
      return fmt::format("joined with {}, whose clock is {:+.3f} ms off ours (+-{:.3f} ms)",
                         printable(peer.host), 1e3 * peer.clock.offset, 1e3 * peer.clock.error);
    case PeerState::kSilent:
    case PeerState::kRefused:
      return printable(peer.trouble);
    case PeerState::kNew:
      break;
  }
  return printable(peer.host) + " is there";
}

LinkPeers::LinkPeers(std::string host, std::int64_t gateway, ProtocolVersion protocol,
                     double max_offset)
    : host_(std::move(host)),
      gateway_(gateway),
      protocol_(std::move(protocol)),
      max_offset_(max_offset) {}

LinkHeartbeat LinkPeers::ping(std::int64_t now) const {
  LinkHeartbeat heartbeat;
  heartbeat.host = host_;
  heartbeat.gateway = gateway_;
  heartbeat.protocol = protocol_;
  heartbeat.sent = now;
  return heartbeat;
}

LinkPeer* LinkPeers::admit(std::int64_t now, const LinkHeartbeat& heartbeat) {
  const auto found = peers_.find(heartbeat.host);
  if (found == peers_.end() && peers_.size() >= kMostPeers) return nullptr;
  if (found != peers_.end()) {
    LinkPeer& old = found->second;
    if (old.gateway == heartbeat.gateway) return &old;
    // A restart, or a second gateway of the same name: the later start counts while both are alive.
    if (heartbeat.gateway < old.gateway && now - old.heard <= kSilent) {
      old.double_heard = now;
      return nullptr;
    }
  }
  LinkPeer& peer = peers_[heartbeat.host] = {};
  peer.host = heartbeat.host;
  peer.gateway = heartbeat.gateway;
  peer.met = now;
  changed_ = true;
  return &peer;
}

bool LinkPeers::hear(std::int64_t now, const LinkHeartbeat& heartbeat, LinkHeartbeat& answer) {
  if (heartbeat.gateway == gateway_ && heartbeat.host == host_) return false;  // ourselves
  if (!heartbeat.hasShortTexts()) return false;
  LinkPeer* peer = admit(now, heartbeat);
  if (peer == nullptr) return false;
  peer->heard = now;
  peer->protocol = heartbeat.protocol;
  if (heartbeat.to == gateway_) {
    peer->round_trips.add(heartbeat.sent, heartbeat.there, heartbeat.answered, now);
    peer->clock = peer->round_trips.estimate();
    peer->refusal = heartbeat.refusal;
  }
  updateState(now, *peer);
  if (heartbeat.to != 0) return false;
  answer = ping(heartbeat.sent);
  answer.to = heartbeat.gateway;
  answer.there = now;
  answer.answered = now;
  answer.refusal = refusalOf(*peer);
  return true;
}

void LinkPeers::alive(std::int64_t now, const std::string& host, std::int64_t gateway) {
  const auto found = peers_.find(host);
  if (found == peers_.end() || found->second.gateway != gateway) return;
  found->second.heard = now;
  updateState(now, found->second);
}

bool LinkPeers::tick(std::int64_t now) {
  // After a pause of this process the peers were not silent: their messages wait to be read.
  const bool slept = ticked_ != 0 && now - ticked_ > kSilent / 2;
  ticked_ = now;
  for (auto& [host, peer] : peers_) {
    if (slept && peer.state != PeerState::kSilent)
      peer.heard = std::max(peer.heard, now - kSilent / 2);
    updateState(now, peer);
  }
  return std::exchange(changed_, false);
}

std::string LinkPeers::clockTrouble(const LinkPeer& peer) const {
  if (std::isnan(peer.clock.offset)) return "";
  const bool refused = peer.state == PeerState::kRefused;
  const double most = refused ? kBetterThanNeeded * max_offset_ : max_offset_;
  // Refuses only an offset above the limit by more than its error: a slow network is no clock
  // error.
  if (std::abs(peer.clock.offset) - peer.clock.error <= most) return "";
  return "the clock of " + peer.host + " is " + asText(std::abs(peer.clock.offset)) +
         (peer.clock.offset > 0 ? " ahead of" : " behind") + " that of " + host_ + " (known to " +
         asText(peer.clock.error) + "), expected at most " + asText(max_offset_) +
         " (link.max_clock_offset_ms). Set both by the network and start the run again: sudo "
         "systemctl start chrony on " +
         peer.host + " and on " + host_;
}

std::string LinkPeers::refusalOf(const LinkPeer& peer) const {
  if (peer.host == host_) {
    return "two hosts call themselves " + host_ +
           ": each needs a name of its own (--link-host, [hosts.NAME])";
  }
  if (!protocol_.fits(peer.protocol)) {
    return peer.host + " speaks " + asText(peer.protocol) + ", " + host_ + " speaks " +
           asText(protocol_) + ": install the same version of the lab on both";
  }
  return clockTrouble(peer);
}

void LinkPeers::updateState(std::int64_t now, LinkPeer& peer) {
  std::string trouble = refusalOf(peer);
  PeerState state = PeerState::kRefused;
  if (trouble.empty() && !peer.refusal.empty()) {
    trouble = peer.host + " refuses us: " + peer.refusal;
  } else if (trouble.empty()) {
    const bool clock = !std::isnan(peer.clock.offset);
    state = clock ? PeerState::kJoined : PeerState::kNew;
    if (!clock && now - peer.met > kNoAnswer) {
      trouble = peer.host +
                " is heard but does not answer: is the way back open (its --link-peer, " +
                "firewalls: UDP)?";
    }
  }
  if (trouble.empty() && peer.double_heard != 0 && now - peer.double_heard <= kNoAnswer) {
    trouble = "two gateways call themselves " + peer.host +
              ": each host needs one gateway and a name of its own (--link-host)";
  }
  if (now - peer.heard > kSilent) {
    state = PeerState::kSilent;
    if (trouble.empty()) trouble = "nothing heard of " + peer.host + ": cable, host or its gateway";
  }
  if (state != peer.state) changed_ = true;
  peer.state = state;
  peer.trouble = std::move(trouble);
}

const LinkPeer* LinkPeers::find(const std::string& host, std::int64_t gateway) const {
  const auto found = peers_.find(host);
  return found != peers_.end() && found->second.gateway == gateway ? &found->second : nullptr;
}

}  // namespace lab::gateway
