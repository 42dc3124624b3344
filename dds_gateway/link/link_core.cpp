#include "dds_gateway/link/link_core.hpp"

#include <algorithm>
#include <array>
#include <lab/robot_stop_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/count_limits.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/math/saturated.hpp"

namespace lab::gateway {
namespace {

/// Measurements, which late joiners do not get: single old samples are of no use.
constexpr std::array kMeasurements{channels::kTrackedFrame,  channels::kTrackedDetails,
                                   channels::kRobotSteps,    channels::kLightSeen,
                                   channels::kLightDelivery, channels::kAnalysis,
                                   channels::kSimTruth,      channels::kCollective};

constexpr std::int64_t kEchoLost = 10'000'000;  // [us]

bool isCommand(std::string_view channel) {
  return channel == channels::kRobotCommand || channel == channels::kLightCommand ||
         channel == channels::kRobotStop;  // its release: see isStop()
}

/// @return the header if it is a message of the lab. Other types may hold anything at the place of
///   the header.
std::optional<MessageHeader> passed(std::string_view channel, Bytes data) {
  if (channel.size() > 63) return std::nullopt;  // LCM's limit
  const std::optional<MessageHeader> header = peekHeader(data);
  if (!header || typeWithFingerprint(header->fingerprint).empty()) return std::nullopt;
  return header;
}

bool staysHere(std::string_view channel) {
  return channel == channels::kClock || channel == channels::kLcmSelfTest;
}

}  // namespace

bool LinkCore::isStop(std::string_view channel, Bytes data) {
  if (channel != channels::kRobotStop) return false;
  robot_stop_t stop{};
  return decode(data, stop) && stop.clear == 0;
}

bool LinkCore::isAtHome(std::int64_t now, const MessageHeader& header) {
  const Sender key{std::string(header.sender), header.instance};
  Home* home = homes_.find(key);
  if (home == nullptr) {
    homes_.add(key, {"", now});
    return true;
  }
  if (home->host.empty()) {
    home->heard = now;
    return true;
  }
  if (home->brought > 0) {
    --home->brought;
  } else {
    *home = {"", now};  // not an echo of ours
  }
  return false;
}

LinkCore::Home* LinkCore::homeOn(const std::string& host, std::int64_t now,
                                 const MessageHeader& header) {
  const Sender key{std::string(header.sender), header.instance};
  Home* home = homes_.find(key);
  if (home == nullptr) {
    homes_.add(key, {host, now});
    return homes_.find(key);
  }
  if (home->host.empty() && now - home->heard > home_holds_) *home = {host, now};
  if (home->host != host) return nullptr;
  // Does not wait for echoes that our own socket lost.
  if (now - home->heard > kEchoLost) home->brought = 0;
  home->heard = now;
  return home;
}

std::optional<Outgoing> LinkCore::hear(std::int64_t now, std::string_view channel, Bytes data) {
  if (staysHere(channel)) return std::nullopt;
  const std::optional<MessageHeader> header = passed(channel, data);
  if (!header) {
    ++foreign_;
    return std::nullopt;
  }
  if (!isAtHome(now, *header)) return std::nullopt;
  const StreamName name{std::string(channel), std::string(header->sender), header->instance};
  Sent* sent = sent_.find(name);
  if (sent == nullptr) {
    const auto next = static_cast<std::int32_t>(sent_.size());
    const auto gone = sent_.add(name, {next, ++streams_, 0});
    sent = sent_.find(name);
    if (gone) sent->slot = gone->slot;
  }
  return Outgoing{sent->stream, ++sent->number, sent->slot};
}

Verdict LinkCore::receive(std::int64_t now, const std::string& host, std::int64_t gateway,
                          std::int32_t stream, std::int64_t number, std::int64_t age,
                          std::string_view channel, Bytes data) {
  const std::optional<MessageHeader> header = passed(channel, data);
  const bool known = hosts_.contains(host);
  if (!header || staysHere(channel) || (!known && hosts_.size() >= kMostHosts)) {
    ++foreign_;
    return Verdict::kForeign;
  }
  From& from = hosts_[host];
  if (from.gateway != gateway) {  // it was restarted and counts from 1
    from.gateway = gateway;
    from.counts = {};
    from.last.clear();
  }
  Home* home = homeOn(host, now, *header);
  if (home == nullptr) {
    ++from.counts.clashing;
    return Verdict::kClash;
  }
  std::int64_t* last = from.last.find(stream);
  const bool first = last == nullptr;
  if (first) {
    from.last.add(stream, number);
  } else if (number <= *last) {
    ++from.counts.repeated;
    return Verdict::kRepeated;
  } else {
    from.counts.lost =
        limitedSum(from.counts.lost, saturatedDifference(number, *last) - 1, kMostOnLink);
    *last = number;
  }
  if (age > kFreshCommand && !isStop(channel, data)) {
    if (isCommand(channel)) {
      ++from.counts.stale;
      return Verdict::kStale;
    }
    if (first && std::ranges::find(kMeasurements, channel) != kMeasurements.end()) {
      return Verdict::kHistory;
    }
  }
  ++from.counts.received;
  ++home->brought;
  return Verdict::kDeliver;
}

LinkCounts LinkCore::counts(const std::string& host) const {
  const auto found = hosts_.find(host);
  return found != hosts_.end() ? found->second.counts : LinkCounts{};
}

std::size_t LinkCore::size() const {
  std::size_t size = homes_.size() + sent_.size();
  for (const auto& [host, from] : hosts_) size += from.last.size();
  return size;
}

}  // namespace lab::gateway
