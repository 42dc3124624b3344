#include "dds_gateway/link/bus_link.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <deque>
#include <lab/link_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <optional>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/dds/waker.hpp"
#include "dds_gateway/link/link.h"
#include "dds_gateway/link/link_core.hpp"
#include "dds_gateway/link/link_peers.hpp"

namespace lab::gateway {
namespace {

using Packed = lab_link_Packet;
using Signed = lab_link_Sign;

constexpr std::int64_t kPingPeriod = 250'000;   // [us] four chances to be heard within a second
constexpr std::int64_t kTickPeriod = 50'000;    // [us]
constexpr int kMostAtOnce = 1000;               // of a flood, so that timers get their turn
constexpr std::int64_t kPatience = 10'000'000;  // [us] before peers that never came are missed

/// Of each stream, for a peer that is away: ten seconds of 100 Hz. Cyclone gives a peer up after
/// that time. What is acknowledged is kept no longer, but for the last one.
constexpr int kKept = 1000;
/// A write that waited longer is counted and given up: a peer that has stopped reading costs the
/// others this much at most.
constexpr double kMostBlocking = 0.002;  // [s]
/// What waits for a peer's clock to be known.
constexpr std::size_t kMostHeld = 2000;
constexpr std::size_t kMostHeldBytes = 16'000'000;

dds::Qos packetQos() {
  dds::Qos qos;
  qos.latched = true;
  qos.latched_depth = 1;
  qos.depth = kKept;
  qos.max_blocking_time = kMostBlocking;
  return qos;
}

dds::Qos signQos() {
  dds::Qos qos;
  qos.reliable = false;  // one that is late says less than the next
  qos.depth = 64;
  return qos;
}

std::string topicOf(const BusLinkOptions& options, const std::string& what) {
  return "lab/link/" + options.key + "/" + what;
}

/// Those of another contract never meet: their topic has another name.
std::string packetTopic(const BusLinkOptions& options) {
  return topicOf(options, "packets/" + std::to_string(options.edition.contract) + "/" +
                              options.edition.fingerprints);
}

/// Cyclone's C structs take char*, and only read.
char* text(const std::string& words) { return const_cast<char*>(words.c_str()); }

struct Held {
  std::int64_t gateway;
  std::int32_t stream;
  std::int64_t number;
  std::int64_t heard;
  std::string channel;
  std::vector<std::uint8_t> data;
};

void sayState(const LinkPeer& peer) {
  switch (peer.state) {
    case PeerState::kJoined:
      spdlog::info("link: joined with {}, whose clock is {:+.3f} ms off ours (+-{:.3f} ms)",
                   peer.host, 1e3 * peer.clock.offset, 1e3 * peer.clock.error);
      break;
    case PeerState::kSilent:
    case PeerState::kRefused:
      spdlog::warn("link: {}", peer.trouble);
      break;
    case PeerState::kNew:
      spdlog::info("link: {} is there", peer.host);
      break;
  }
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

  void passOn(const Packet& packet);
  [[nodiscard]] bool isOwn(const Packet& packet) const;
  [[nodiscard]] bool waitsForPeers();
  void passOnEarly();
  void noteOwn(const Packet& packet);
  [[nodiscard]] bool isForwarding();
  void takeAll();
  void take(const Packed& packed);
  void take(const Signed& sign);
  void deliver(const std::string& host, const ClockOffset& clock, const Held& packet, Bytes data);
  void release();
  void send(const LinkHeartbeat& sign);
  void tick();
  void tell();
  void reportMissingPeers();

  Node& node;
  Loop& loop;
  BusLinkOptions options;
  std::int64_t gateway;
  std::int64_t started;
  LinkCore core;
  LinkPeers peers;
  std::map<std::string, std::int64_t> sent;      ///< packets, by host
  std::map<std::string, PeerState> said;         ///< in the log
  std::map<std::string, std::deque<Held>> held;  ///< by host
  std::size_t held_bytes = 0;
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> early;  ///< channel, message
  bool all_were_there = false;
  bool missed = false;
  bool leaving = false;     ///< the node has said its last, which counts what there is of it
  bool heard_last = false;  ///< that has come back from the bus

  dds::Waker waker;
  dds::Domain domain;
  dds::Writer packets_out;
  dds::Writer signs_out;
  dds::Reader packets_in;
  dds::Reader signs_in;
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
      peers(options.host, gateway, options.edition, options.most_offset),
      domain(options.domain,
             dds::networkConfiguration({.address = options.address,
                                        .peers = options.peers,
                                        .multicast = false,
                                        .security = options.security,
                                        .unthrottled_writers = true}),
             "link"),
      packets_out(domain, lab_link_Packet_desc, packetTopic(options), packetQos()),
      signs_out(domain, lab_link_Sign_desc, topicOf(options, "signs"), signQos()),
      packets_in(domain, lab_link_Packet_desc, packetTopic(options), packetQos(), waker),
      signs_in(domain, lab_link_Sign_desc, topicOf(options, "signs"), signQos(), waker) {
  watch = descriptors.watch(waker.fileDescriptor(), [this] { takeAll(); });
  node.subscribeAll([this](const Packet& packet) { passOn(packet); });
  loop.every(kPingPeriod, loop.now(), [this] { send(peers.ping(now())); });
  loop.every(kTickPeriod, loop.now() + kTickPeriod, [this] { tick(); });
  loop.every(units::kSecond_us, loop.now() + units::kSecond_us, [this] { tell(); });
}

bool BusLink::Implementation::isOwn(const Packet& packet) const {
  const std::optional<MessageHeader> header = peekHeader(packet.data);
  return header && header->instance == gateway && header->sender == node.identity().name;
}

/// Our first words come before anybody can hear them, and would be missing in the others' counts.
bool BusLink::Implementation::waitsForPeers() {
  if (all_were_there) return false;
  all_were_there = leaving || loop.now() - started > kPatience ||
                   packets_out.matching().peers >= static_cast<int>(options.peers.size());
  return !all_were_there;
}

void BusLink::Implementation::passOnEarly() {
  if (early.empty() || waitsForPeers()) return;
  for (const auto& [channel, data] : std::exchange(early, {})) passOn({channel, data, 0});
}

void BusLink::Implementation::passOn(const Packet& packet) {
  if (!all_were_there && isOwn(packet)) {
    if (waitsForPeers()) {
      early.emplace_back(packet.channel, std::vector(packet.data.begin(), packet.data.end()));
      return;
    }
    passOnEarly();
  }
  const auto outgoing = core.hear(loop.now(), packet.channel, packet.data);
  if (!outgoing) return;
  const std::string channel(packet.channel);
  Packed packed{};
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

/// Each closing message says how many there will have been.
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
  waker.quiet();
  const int signs = signs_in.take(kMostAtOnce, [this](const void* sample, dds::WriterId) {
    take(*static_cast<const Signed*>(sample));
  });
  // What waited for a peer's clock goes before what comes now: numbers rise within a stream.
  release();
  const int packets = packets_in.take(kMostAtOnce, [this](const void* sample, dds::WriterId) {
    take(*static_cast<const Packed*>(sample));
  });
  if (signs == kMostAtOnce || packets == kMostAtOnce) waker.ring();
  release();
}

void BusLink::Implementation::take(const Signed& sample) {
  LinkHeartbeat sign{
      sample.host,     sample.gateway, {sample.contract, sample.fingerprints, sample.version},
      sample.to,       sample.sent,    sample.there,
      sample.answered, sample.refusal};
  LinkHeartbeat answer;
  if (peers.hear(now(), sign, answer)) send(answer);
}

void BusLink::Implementation::take(const Packed& packed) {
  const std::string host = packed.host;
  peers.alive(now(), host, packed.gateway);
  const LinkPeer* peer = peers.find(host, packed.gateway);
  Held packet{packed.gateway, packed.stream, packed.number, packed.heard, packed.channel, {}};
  const Bytes data{packed.data._buffer, packed.data._length};
  const bool joined = peer != nullptr && peer->state == PeerState::kJoined;
  if (joined || LinkCore::isStop(packet.channel, data)) {
    deliver(host, peer != nullptr ? peer->clock : ClockOffset{}, packet, data);
    return;
  }
  if (peer != nullptr && peer->state == PeerState::kRefused) return;
  if (held.size() >= LinkPeers::kMostPeers && !held.contains(host)) return;
  if (data.size() > kMostHeldBytes) return;
  auto& waiting = held[host];
  packet.data.assign(data.begin(), data.end());
  held_bytes += data.size();
  waiting.push_back(std::move(packet));
  // The oldest go. Their streams have a gap then, which counts as lost.
  while (waiting.size() > 1 && (waiting.size() > kMostHeld || held_bytes > kMostHeldBytes)) {
    held_bytes -= waiting.front().data.size();
    waiting.pop_front();
  }
}

void BusLink::Implementation::deliver(const std::string& host, const ClockOffset& clock,
                                      const Held& packet, Bytes data) {
  // A stop of a host whose clock is not known is carried out whatever its age.
  const double offset = std::isnan(clock.offset) ? 0 : clock.offset;
  const std::int64_t age = now() + units::microseconds(offset) - packet.heard;
  const Verdict verdict = core.receive(loop.now(), host, packet.gateway, packet.stream,
                                       packet.number, age, packet.channel, data);
  if (verdict == Verdict::kDeliver) node.forward(packet.channel, data);
}

void BusLink::Implementation::release() {
  for (auto entry = held.begin(); entry != held.end();) {
    const auto peer = peers.all().find(entry->first);
    if (peer == peers.all().end() || peer->second.state == PeerState::kNew ||
        peer->second.state == PeerState::kSilent) {
      ++entry;
      continue;
    }
    const LinkPeer& from = peer->second;
    for (const Held& packet : entry->second) {
      held_bytes -= packet.data.size();
      // Of an earlier start of that gateway: it is not there any more, and its numbers are not.
      if (packet.gateway != from.gateway || from.state != PeerState::kJoined) continue;
      deliver(from.host, from.clock, packet, packet.data);
    }
    entry = held.erase(entry);
  }
}

void BusLink::Implementation::send(const LinkHeartbeat& sign) {
  Signed sample{};
  sample.host = text(sign.host);
  sample.gateway = sign.gateway;
  sample.contract = sign.edition.contract;
  sample.fingerprints = text(sign.edition.fingerprints);
  sample.version = text(sign.edition.version);
  sample.to = sign.to;
  sample.sent = sign.sent;
  sample.there = sign.there;
  sample.answered = sign.answered;
  sample.refusal = text(sign.refusal);
  signs_out.write(&sample);
}

void BusLink::Implementation::tick() {
  passOnEarly();
  if (peers.tick(now())) tell();
  release();
  // Until its clock is known a new peer is asked in quick succession.
  for (const auto& [host, peer] : peers.all()) {
    if (peer.state != PeerState::kNew) continue;
    send(peers.ping(now()));
    break;
  }
  reportMissingPeers();
}

void BusLink::Implementation::reportMissingPeers() {
  if (missed || loop.now() - started < kPatience) return;
  missed = true;
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

void BusLink::Implementation::tell() {
  if (leaving) return;
  link_status_t status{};
  status.host = options.host;
  status.allowed_clock_offset = options.most_offset;
  status.foreign = core.foreign();
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
    PeerState& before = said[host];
    if (before != peer.state) {
      before = peer.state;
      sayState(peer);
    }
    // A peer that is not joined is seen in LINK_STATUS, and whoever watches that says so.
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
