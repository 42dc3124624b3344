#include "runner/commands/spy_table.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/received_message.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"

namespace lab::runner {

void SpyTable::take(const Packet& packet) {
  const auto header = peekHeader(packet.data);
  const std::string_view type = header ? typeWithFingerprint(header->fingerprint) : "";
  if (type.empty()) {
    counter_.countDecodeError(packet.channel);
    return;
  }
  counter_.count(packet.channel, header->sender, header->instance, header->seq, header->utime);
  if (packet.channel == channels::kLinkStatus) takeLink(packet);
  StreamKey key{std::string(packet.channel), std::string(header->sender), header->instance};
  if (!counter_.streams().contains(key)) return;
  if (heard_.size() >= 2 * StreamCounter::kMostStreams) forgetReplaced();
  Heard& heard = heard_[std::move(key)];
  heard.type = type;
  heard.bytes = static_cast<std::int64_t>(packet.data.size());
  heard.last_received_utime = packet.received_utime;
}

void SpyTable::takeLink(const Packet& packet) {
  const auto received = receive<link_status_t>(packet);
  if (!received->decoded || received->removed) return;
  const link_status_t& status = received->message;
  if (links_.size() >= kMostHosts && !links_.contains(status.host)) return;
  link_status_t& kept = links_[status.host];
  kept = status;
  if (kept.peers.size() > kMostHosts) kept.peers.resize(kMostHosts);
  kept.num_peers = static_cast<std::int32_t>(kept.peers.size());
}

/// The counter gives the place of a silent stream to another one.
void SpyTable::forgetReplaced() {
  std::erase_if(heard_,
                [this](const auto& stream) { return !counter_.streams().contains(stream.first); });
}

std::string SpyTable::text(double interval, std::int64_t now) {
  forgetReplaced();
  std::string text = fmt::format("{:<17} {:<18} {:<14} {:>8} {:>8} {:>8} {:>9} {:>7}\n", "channel",
                                 "type", "sender", "Hz", "bytes", "age ms", "received", "lost");
  const auto put = std::back_inserter(text);
  for (const auto& [key, stream] : counter_.streams()) {
    Heard& heard = heard_[key];
    const double rate =
        static_cast<double>(stream.received - heard.received_at_last_show) / interval;
    heard.received_at_last_show = stream.received;
    const std::string lost = seqCountsMessages(key.channel) ? fmt::format("{}", stream.lost) : "-";
    fmt::format_to(put, "{:<17} {:<18} {:<14} {:>8.1f} {:>8} {:>8.0f} {:>9} {:>7}\n",
                   printable(key.channel), printable(heard.type), printable(key.sender), rate,
                   heard.bytes, units::seconds(now - heard.last_received_utime) * 1000,
                   stream.received, lost);
  }
  if (counter_.uncounted() > 0) {
    fmt::format_to(put, "{} messages of further streams: {} are listed at most\n",
                   counter_.uncounted(), StreamCounter::kMostStreams);
  }
  for (const auto& [channel, errors] : counter_.decodeErrors()) {
    fmt::format_to(put,
                   "{:<17} NOT DECODED {:>8} messages: other message versions, another program, or "
                   "a sender's name above {} bytes\n",
                   printable(channel), errors, kLongestSender);
  }
  if (counter_.furtherDecodeErrors() > 0) {
    fmt::format_to(put, "{:<17} NOT DECODED {:>8} messages\n", "(other channels)",
                   counter_.furtherDecodeErrors());
  }
  return text + linksText();
}

std::string SpyTable::linksText() const {
  static constexpr std::array kStates{"?", "joined", "SILENT", "REFUSED"};
  std::string text;
  for (const auto& [host, status] : links_) {
    for (const link_peer_t& peer : status.peers) {
      const auto state = static_cast<std::size_t>(peer.state);
      text += fmt::format(
          "link {} - {}: {}, clock {:+.2f} ms, lost {}, received {} {}\n", printable(host),
          printable(peer.host), state < kStates.size() ? kStates[state] : kStates[0],
          peer.clock_offset * 1e3, peer.lost, peer.received, printable(peer.trouble));
    }
  }
  return text;
}

}  // namespace lab::runner
