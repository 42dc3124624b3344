#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <lab/link_status_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/stream_counter.hpp"
#include "common/bus/udpm_url.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/commands/commands.hpp"
#include "runner/runs/lab_registry.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kShow_us = 1'000'000;

/// Of one stream, beside its counts.
struct Heard {
  std::string type;
  std::int64_t received_at_last_show = 0;
  std::int64_t bytes = 0;
  std::int64_t last_received_utime = 0;
};

/// A table of every stream on a bus, once a second.
class Spy {
 public:
  Spy(std::string name, const std::string& url) : name_(std::move(name)), bus_(url) {
    bus_.subscribeAll([this](const Packet& packet) { take(packet); });
  }

  void execute(const std::optional<double>& longest_s) {
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.onSignals({SIGINT, SIGTERM}, [this](int) { loop_.stop(); });
    const std::int64_t start = loop_.now();
    last_show_utime_ = start;
    loop_.every(kShow_us, start + kShow_us, [this] { show(); });
    if (longest_s) loop_.at(start + units::microseconds(*longest_s) + 1, [this] { loop_.stop(); });
    loop_.run();
  }

 private:
  void take(const Packet& packet) {
    const auto header = peekHeader(packet.data);
    const std::string_view type = header ? typeWithFingerprint(header->fingerprint) : "";
    if (type.empty()) {
      counter_.countDecodeError(packet.channel);
      return;
    }
    counter_.count(packet.channel, header->sender, header->instance, header->seq, header->utime);
    Heard& heard =
        heard_[{std::string(packet.channel), std::string(header->sender), header->instance}];
    if (link_status_t status{};
        packet.channel == channels::kLinkStatus && decode(packet.data, status)) {
      links_[status.host] = status;
    }
    heard.type = type;
    heard.bytes = static_cast<std::int64_t>(packet.data.size());
    heard.last_received_utime = packet.received_utime;
  }

  void show() {
    const std::int64_t now = loop_.now();
    const double interval = units::seconds(now - last_show_utime_);
    last_show_utime_ = now;
    if (isatty(STDOUT_FILENO) == 1) fmt::print("\033[H\033[2J");
    fmt::print("{}\n{:<17} {:<18} {:<14} {:>8} {:>8} {:>8} {:>9} {:>7}\n", name_, "channel", "type",
               "sender", "Hz", "bytes", "age ms", "received", "lost");
    for (const auto& [key, stream] : counter_.streams()) {
      Heard& heard = heard_[key];
      const double rate =
          static_cast<double>(stream.received - heard.received_at_last_show) / interval;
      heard.received_at_last_show = stream.received;
      const std::string lost =
          seqCountsMessages(key.channel) ? fmt::format("{}", stream.lost) : "-";
      fmt::print("{:<17} {:<18} {:<14} {:>8.1f} {:>8} {:>8.0f} {:>9} {:>7}\n",
                 printable(key.channel), printable(heard.type), printable(key.sender), rate,
                 heard.bytes, units::seconds(now - heard.last_received_utime) * 1000,
                 stream.received, lost);
    }
    for (const auto& [channel, errors] : counter_.decodeErrors()) {
      fmt::print("{:<17} NOT DECODED {:>8} messages: other message versions, or another program\n",
                 printable(channel), errors);
    }
    showLinks();
    for (const std::string& line : bus_.refused().linesSince({})) fmt::print("{}\n", line);
    fmt::print("\n");
    std::fflush(stdout);
  }

  void showLinks() const {
    static constexpr std::array kStates{"?", "joined", "SILENT", "REFUSED"};
    for (const auto& [host, status] : links_) {
      for (const link_peer_t& peer : status.peers) {
        const auto state = static_cast<std::size_t>(peer.state);
        fmt::print("link {} - {}: {}, clock {:+.2f} ms, lost {}, received {} {}\n", printable(host),
                   printable(peer.host), state < kStates.size() ? kStates[state] : kStates[0],
                   peer.clock_offset * 1e3, peer.lost, peer.received, printable(peer.trouble));
      }
    }
  }

  std::string name_;
  AsioLoop loop_;
  LcmBus bus_;
  StreamCounter counter_;
  std::map<StreamKey, Heard> heard_;
  std::map<std::string, link_status_t> links_;  ///< by reporting host
  std::int64_t last_show_utime_ = 0;
};

}  // namespace

ExitCode spy(const SpyOptions& options) {
  if (!options.url.empty()) {
    if (!parseUdpmUrl(options.url)) {
      throw UserError("--lcm-url: found " + options.url +
                      ", expected the URL of a bus as lab run prints it: "
                      "udpm://239.255.76.67:7667?ttl=0");
    }
    Spy(options.url, options.url).execute(options.seconds);
  } else {
    const RunningLab lab = findLab(options.lab);
    Spy(lab.name, lab.url).execute(options.seconds);
  }
  return kDone;
}

}  // namespace lab::runner
