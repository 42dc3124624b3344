#include "dds_gateway/link/bus_link.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstring>
#include <lab/link_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <optional>
#include <utility>

#include "common/bus/bus_error.hpp"
#include "common/bus/channels.hpp"
#include "common/math/saturated.hpp"
#include "common/math/units.hpp"
#include "common/process/event_descriptor.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/dds/error.hpp"
#include "dds_gateway/link/held_packets.hpp"
#include "dds_gateway/link/link.h"
#include "dds_gateway/link/link_core.hpp"
#include "dds_gateway/link/link_peers.hpp"

namespace lab::gateway {
namespace {

using WirePacket = lab_link_Packet;
using WireHeartbeat = lab_link_Sign;

constexpr std::int64_t kPingPeriod = 250'000;  // [us] four pings per second
constexpr std::int64_t kTickPeriod = 50'000;   // [us]
constexpr int kMostAtOnce = 1000;  // samples per call, so that timers run during a flood
constexpr std::int64_t kDiscoveryTime = 10'000'000;  // [us] then missing peers are reported

/// Messages kept of each stream for a peer that is away: ten seconds at 100 Hz, after which Cyclone
/// gives the peer up. Of acknowledged messages only the last one is kept.
constexpr int kKept = 1000;
/// Maximal duration of a write, after which it is counted and given up. A peer that has stopped
/// reading delays the others by this at most.
constexpr double kMostBlocking = 0.002;  // [s]

dds::Qos packetQos() {
  dds::Qos qos;
  qos.latched = true;
  qos.latched_depth = 1;
  qos.depth = kKept;
  qos.max_blocking_time = kMostBlocking;
  return qos;
}

dds::Qos heartbeatQos() {
  dds::Qos qos;
  qos.reliable = false;  // the next heartbeat is better than a late one
  qos.depth = 64;
  return qos;
}

std::string topicOf(const BusLinkOptions& options, const std::string& what) {
  return "lab/link/" + options.key + "/" + what;
}

/// The name contains the message contract, so gateways of different contracts are not matched.
std::string packetTopic(const BusLinkOptions& options) {
  return topicOf(options, "packets/" + std::to_string(options.protocol.contract) + "/" +
                              options.protocol.fingerprints);
}

/// Cyclone's C structs take char* but do not write to it.
char* text(const std::string& words) { return const_cast<char*>(words.c_str()); }

/// Whether a text of another host has at most this length [byte]. Reads no further.
bool isWithin(const char* words, std::size_t longest) {
  return strnlen(words, longest + 1) <= longest;
}

bool hasShortTexts(const WirePacket& packed) {
  return isWithin(packed.host, LinkHeartbeat::kLongestName) &&
         isWithin(packed.channel, kLongestChannelName);
}

void logState(const LinkPeer& peer) {
  const bool bad = peer.state == PeerState::kSilent || peer.state == PeerState::kRefused;
  spdlog::log(bad ? spdlog::level::warn : spdlog::level::info, "link: {}", stateText(peer));
}

std::int8_t stateOf(const LinkPeer& peer) {
  switch (peer.state) {
    case PeerState::kJoined:
      return link_peer_t::JOINED;
    case PeerState::kRefused:
      return link_peer_t::REFUSED;
    case PeerState::kNew:
    case PeerState::kSilent:
      break;
  }
  return link_peer_t::SILENT;
}

}  // namespace

struct BusLink::Implementation {
  Implementation(Node& its_node, Loop& its_loop, DescriptorWatcher& descriptors,
                 const BusLinkOptions& its_options);

  [[nodiscard]] std::int64_t now() const { return options.clock ? options.clock() : loop.now(); }

  void forwardPacket(const Packet& packet);
  [[nodiscard]] bool isOwn(const Packet& packet) const;
  [[nodiscard]] bool waitsForPeers();
  void forwardEarly();
  void noteOwn(const Packet& packet);
  [[nodiscard]] bool isForwarding();
  void takeAll();
  void take(const WirePacket& packed);
  void take(const WireHeartbeat& heartbeat);
  void deliver(const std::string& host, const ClockOffset& clock, const HeldPacket& packet,
               Bytes data);
  void release();
  void send(const LinkHeartbeat& heartbeat);
  void tick();
  void publishStatus();
  void reportMissingPeers();

  Node& node;
  Loop& loop;
  BusLinkOptions options;
  std::int64_t gateway;
  std::int64_t started;
  LinkCore core;
  LinkPeers peers;
  std::map<std::string, std::int64_t> sent;  ///< packets, by host
  std::map<std::string, PeerState> logged;   ///< last logged state, by host
  HeldPackets held{LinkPeers::kMostPeers};
  std::int64_t too_long = 0;  ///< samples with texts that no gateway sends
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> early;  ///< channel, message
  bool all_peers_found = false;
  bool reported_missing = false;
  bool leaving = false;     ///< the node has published its closing messages
  bool heard_last = false;  ///< the last of them has come back from the bus

  EventDescriptor waker;
  dds::Domain domain;
  dds::Writer packets_out;
  dds::Writer heartbeats_out;
  dds::Reader packets_in;
  dds::Reader heartbeats_in;
  std::unique_ptr<DescriptorWatcher::Watch> watch;
};

BusLink::Implementation::Implementation(Node& its_node, Loop& its_loop,
                                        DescriptorWatcher& descriptors,
                                        const BusLinkOptions& its_options)
    : node(its_node),
      loop(its_loop),
      options(its_options),
      gateway(node.identity().instance),
      started(loop.now()),
      core(gateway),
      peers(options.host, gateway, options.protocol, options.max_offset),
      domain(options.domain,
             dds::networkConfiguration({.address = options.address,
                                        .peers = options.peers,
                                        .multicast = false,
                                        .security = options.security,
                                        .unthrottled_writers = true}),
             "link"),
      packets_out(domain, lab_link_Packet_desc, packetTopic(options), packetQos()),
      heartbeats_out(domain, lab_link_Sign_desc, topicOf(options, "signs"), heartbeatQos()),
      packets_in(domain, lab_link_Packet_desc, packetTopic(options), packetQos(), waker),
      heartbeats_in(domain, lab_link_Sign_desc, topicOf(options, "signs"), heartbeatQos(), waker) {
  if (options.host.size() > LinkHeartbeat::kLongestName) {
    throw dds::DdsError("found " + options.host + " as the name of this host, expected at most " +
                        std::to_string(LinkHeartbeat::kLongestName) +
                        " characters (--link-host, [hosts.NAME])");
  }
  watch = descriptors.watch(waker.get(), [this] { takeAll(); });
  node.subscribeAll([this](const Packet& packet) { forwardPacket(packet); });
  loop.every(kPingPeriod, loop.now(), [this] { send(peers.ping(now())); });
  loop.every(kTickPeriod, loop.now() + kTickPeriod, [this] { tick(); });
  loop.every(units::kSecond_us, loop.now() + units::kSecond_us, [this] { publishStatus(); });
}

bool BusLink::Implementation::isOwn(const Packet& packet) const {
  const std::optional<MessageHeader> header = peekHeader(packet.data);
  return header && header->instance == gateway && header->sender == node.identity().name;
}

/// Whether the first messages of this gateway still wait for the readers of its peers; otherwise
/// they would count as lost there.
bool BusLink::Implementation::waitsForPeers() {
  if (all_peers_found) return false;
  all_peers_found = leaving || loop.now() - started > kDiscoveryTime ||
                    packets_out.matching().peers >= static_cast<int>(options.peers.size());
  return !all_peers_found;
}

void BusLink::Implementation::forwardEarly() {
  if (early.empty() || waitsForPeers()) return;
  for (const auto& [channel, data] : std::exchange(early, {})) forwardPacket({channel, data, 0});
}

void BusLink::Implementation::forwardPacket(const Packet& packet) {
  if (!all_peers_found && isOwn(packet)) {
    if (waitsForPeers()) {
      early.emplace_back(packet.channel, std::vector(packet.data.begin(), packet.data.end()));
      return;
    }
    forwardEarly();
  }
  const auto outgoing = core.hear(loop.now(), packet.channel, packet.data);
  if (!outgoing) return;
  const std::string channel(packet.channel);
  WirePacket packed{};
  packed.gateway = gateway;
  packed.slot = outgoing->slot;
  packed.stream = outgoing->stream;
  packed.host = text(options.host);
  packed.number = outgoing->number;
  packed.heard = now();
  packed.channel = text(channel);
  packed.data._buffer = const_cast<std::uint8_t*>(packet.data.data());
  packed.data._length = static_cast<std::uint32_t>(packet.data.size());
  packed.data._maximum = packed.data._length;
  if (leaving) noteOwn(packet);
  if (!packets_out.write(&packed)) return;
  for (const auto& [host, peer] : peers.all()) {
    if (peer.state != PeerState::kRefused) ++sent[host];
  }
}

/// Each closing message contains the total number of messages.
void BusLink::Implementation::noteOwn(const Packet& packet) {
  service_status_t status{};
  if (packet.channel != channels::kServiceStatus || !isOwn(packet)) return;
  if (!decode(packet.data, status)) return;
  if (status.state != service_status_t::ENDED) return;
  for (const channel_count_t& count : status.sent) {
    if (count.channel == channels::kServiceStatus && count.messages == status.seq)
      heard_last = true;
  }
}

bool BusLink::Implementation::isForwarding() {
  leaving = true;
  return !heard_last || !packets_out.acknowledged();
}

void BusLink::Implementation::takeAll() {
  waker.clear();
  const int heartbeats = heartbeats_in.take(kMostAtOnce, [this](const void* sample, dds::WriterId) {
    take(*static_cast<const WireHeartbeat*>(sample));
  });
  // Held packets are delivered before new ones, because numbers rise within a stream.
  release();
  const int packets = packets_in.take(kMostAtOnce, [this](const void* sample, dds::WriterId) {
    take(*static_cast<const WirePacket*>(sample));
  });
  if (heartbeats == kMostAtOnce || packets == kMostAtOnce) waker.signal();
  release();
}

void BusLink::Implementation::take(const WireHeartbeat& sample) {
  LinkHeartbeat heartbeat{
      sample.host,     sample.gateway, {sample.contract, sample.fingerprints, sample.version},
      sample.to,       sample.sent,    sample.there,
      sample.answered, sample.refusal};
  if (!heartbeat.hasShortTexts()) {
    ++too_long;
    return;
  }
  LinkHeartbeat answer;
  if (peers.hear(now(), heartbeat, answer)) send(answer);
}

void BusLink::Implementation::take(const WirePacket& packed) {
  if (!hasShortTexts(packed)) {
    ++too_long;
    return;
  }
  const std::string host = packed.host;
  peers.alive(now(), host, packed.gateway);
  const LinkPeer* peer = peers.find(host, packed.gateway);
  HeldPacket packet{packed.gateway, packed.stream, packed.number, packed.heard, packed.channel, {}};
  const Bytes data{packed.data._buffer, packed.data._length};
  const bool joined = peer != nullptr && peer->state == PeerState::kJoined;
  if (joined || LinkCore::isStop(packet.channel, data)) {
    deliver(host, peer != nullptr ? peer->clock : ClockOffset{}, packet, data);
    return;
  }
  if (peer != nullptr && peer->state == PeerState::kRefused) return;
  if (data.size() > HeldPackets::kMostBytes) return;
  packet.data.assign(data.begin(), data.end());
  // It may drop older ones. The gaps in their streams count as losses.
  held.add(host, std::move(packet));
}

void BusLink::Implementation::deliver(const std::string& host, const ClockOffset& clock,
                                      const HeldPacket& packet, Bytes data) {
  // A stop is obeyed at any age, even if the clock of its host is not known.
  const double offset = std::isnan(clock.offset) ? 0 : clock.offset;
  const std::int64_t apart = saturatedDifference(now(), packet.heard);
  const auto age =
      saturated<std::int64_t>(static_cast<double>(apart) + offset * double{units::kSecond_us});
  const Verdict verdict = core.receive(loop.now(), host, packet.gateway, packet.stream,
                                       packet.number, age, packet.channel, data);
  if (verdict == Verdict::kDeliver) node.forward(packet.channel, data);
}

void BusLink::Implementation::release() {
  if (held.bytes() == 0) return;
  for (const auto& [host, from] : peers.all()) {
    if (from.state == PeerState::kNew || from.state == PeerState::kSilent) continue;
    for (const HeldPacket& packet : held.take(host)) {
      // Skips packets of an earlier start of that gateway, whose numbers are no longer valid.
      if (packet.gateway != from.gateway || from.state != PeerState::kJoined) continue;
      deliver(from.host, from.clock, packet, packet.data);
    }
  }
}

void BusLink::Implementation::send(const LinkHeartbeat& heartbeat) {
  WireHeartbeat sample{};
  sample.host = text(heartbeat.host);
  sample.gateway = heartbeat.gateway;
  sample.contract = heartbeat.protocol.contract;
  sample.fingerprints = text(heartbeat.protocol.fingerprints);
  sample.version = text(heartbeat.protocol.version);
  sample.to = heartbeat.to;
  sample.sent = heartbeat.sent;
  sample.there = heartbeat.there;
  sample.answered = heartbeat.answered;
  sample.refusal = text(heartbeat.refusal);
  heartbeats_out.write(&sample);
}

void BusLink::Implementation::tick() {
  forwardEarly();
  if (peers.tick(now())) publishStatus();
  release();
  // Sends frequent pings until the clock of a new peer is known.
  for (const auto& [host, peer] : peers.all()) {
    if (peer.state != PeerState::kNew) continue;
    send(peers.ping(now()));
    break;
  }
  reportMissingPeers();
}

void BusLink::Implementation::reportMissingPeers() {
  if (reported_missing || loop.now() - started < kDiscoveryTime) return;
  reported_missing = true;
  if (peers.all().size() >= options.peers.size()) return;
  std::string addresses;
  for (const std::string& address : options.peers) addresses += " " + address;
  const std::string trouble =
      "heard of " + std::to_string(peers.all().size()) + " of " +
      std::to_string(options.peers.size()) + " other hosts (" + addresses.substr(1) +
      "): does each answer (ping), and do firewalls pass UDP ports from " +
      std::to_string(7400 + 250 * options.domain) + " on" +
      (options.security.empty() ? "?"
                                : ", and has each certificates of the same CA (link.security)?");
  spdlog::warn("link: {}", trouble);
  node.noteError("link: " + trouble);
}

void BusLink::Implementation::publishStatus() {
  if (leaving) return;
  link_status_t status{};
  status.host = options.host;
  status.allowed_clock_offset = options.max_offset;
  status.foreign = core.foreign() + too_long;
  status.timeouts = packets_out.timeouts();
  for (const auto& [host, peer] : peers.all()) {
    const LinkCounts counts = core.counts(host);
    link_peer_t row{};
    row.host = host;
    row.instance = peer.gateway;
    row.state = stateOf(peer);
    row.heard_utime = peer.heard;
    row.clock_offset = peer.clock.offset;
    row.clock_error = peer.clock.error;
    row.round_trip = peer.clock.round_trip;
    row.sent = sent[host];
    row.received = counts.received;
    row.lost = counts.lost;
    row.repeated = counts.repeated;
    row.stale = counts.stale;
    row.clashing = counts.clashing;
    row.trouble = peer.trouble;
    if (row.trouble.empty() && counts.clashing > 0) {
      row.trouble = "messages of " + host +
                    " dropped: their senders are heard elsewhere, too. Two gateways on one bus, or "
                    "a network.ttl that lets LCM itself reach " +
                    host + "?";
    }
    PeerState& before = logged[host];
    if (before != peer.state) {
      before = peer.state;
      logState(peer);
    }
    // A peer that is not joined is reported by the programs that read LINK_STATUS.
    if (peer.state == PeerState::kJoined && !row.trouble.empty()) {
      node.noteError("link: " + row.trouble);
    }
    status.peers.push_back(std::move(row));
  }
  status.num_peers = static_cast<std::int32_t>(status.peers.size());
  node.publish(channels::kLinkStatus, status);
}

BusLink::BusLink(Node& node, Loop& loop, DescriptorWatcher& descriptors,
                 const BusLinkOptions& options)
    : implementation_(std::make_unique<Implementation>(node, loop, descriptors, options)) {}

BusLink::~BusLink() = default;

bool BusLink::isForwarding() { return implementation_->isForwarding(); }

}  // namespace lab::gateway
