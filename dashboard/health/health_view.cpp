#include "dashboard/health/health_view.hpp"

#include <algorithm>
#include <cmath>
#include <lab/robot_state_t.hpp>

#include "common/bus/channels.hpp"
#include "common/math/saturated.hpp"
#include "common/math/units.hpp"

namespace lab::dashboard {
namespace {

constexpr std::size_t kMaxNames = 100;  // each of unknown channels, hosts and clocks
constexpr double kClockAhead = 1;       // [s]

const char* stateName(std::int8_t state) {
  switch (state) {
    case service_status_t::STARTING:
      return "starting";
    case service_status_t::READY:
      return "ready";
    case service_status_t::FAULT:
      return "fault";
    case service_status_t::ENDED:
      return "ended";
    default:
      return "unknown";
  }
}

const char* peerStateName(std::int8_t state) {
  switch (state) {
    case link_peer_t::JOINED:
      return "joined";
    case link_peer_t::SILENT:
      return "silent";
    case link_peer_t::REFUSED:
      return "refused";
    default:
      return "unknown";
  }
}

/// Whether it is a live process on this host. Process ids in a replayed log mean nothing now.
bool isOurs(const ServiceRow& row, const std::string& host) {
  return row.status.host == host && row.status.pid != 0 &&
         row.status.origin != robot_state_t::REPLAY;
}

Json trackerJson(const tracker_status_t& tracker, std::int64_t heard, std::int64_t now) {
  constexpr double kMm = 1e3;
  constexpr double kMs = 1e3;
  return {{"camera", tracker.camera},
          {"state", trackerStateName(tracker.state)},
          {"trouble", tracker.trouble},
          {"warning", tracker.warning},
          {"age_s", age(heard, now)},
          {"width_px", tracker.width},
          {"height_px", tracker.height},
          {"fps", number(tracker.fps)},
          {"exposure_ms", number(tracker.exposure * kMs)},
          {"locked", tracker.locked != 0},
          {"moved", tracker.moved != 0},
          {"frames", tracker.frames},
          {"dropped", tracker.dropped},
          {"dark", tracker.dark},
          {"saturated", tracker.saturated},
          {"brightness", number(tracker.brightness)},
          {"caps", tracker.caps},
          {"unbound", tracker.unbound},
          {"flips", tracker.flips},
          {"lost", tracker.lost},
          {"spacing_error_mm", number(tracker.spacing_error * kMm)},
          {"spacing_sigma_mm", number(tracker.spacing_sigma * kMm)},
          {"latency_p50_ms", number(tracker.latency_p50 * kMs)},
          {"latency_p95_ms", number(tracker.latency_p95 * kMs)},
          {"latency_p99_ms", number(tracker.latency_p99 * kMs)}};
}

Json linksJson(const std::map<std::string, link_status_t>& links) {
  constexpr double kMs = 1e3;
  Json json = Json::array();
  for (const auto& [host, link] : links) {
    for (const link_peer_t& peer : link.peers) {
      json.push_back({{"host", host},
                      {"peer", peer.host},
                      {"state", peerStateName(peer.state)},
                      {"trouble", peer.trouble},
                      {"clock_offset_ms", number(peer.clock_offset * kMs)},
                      {"clock_error_ms", number(peer.clock_error * kMs)},
                      {"round_trip_ms", number(peer.round_trip * kMs)},
                      {"sent", peer.sent},
                      {"received", peer.received},
                      {"lost", peer.lost},
                      {"stale", peer.stale},
                      {"clashing", peer.clashing}});
    }
  }
  return json;
}

}  // namespace

const char* trackerStateName(std::int8_t state) {
  switch (state) {
    case tracker_status_t::WAITING:
      return "waiting";
    case tracker_status_t::RUNNING:
      return "running";
    case tracker_status_t::GONE:
      return "gone";
    case tracker_status_t::ENDED:
      return "ended";
    default:
      return "unknown";
  }
}

void HealthView::count(std::string_view channel, const MessageHeader& header, std::int64_t now) {
  const bool same = last_ != nullptr && last_->first.instance == header.instance &&
                    last_->first.channel == channel && last_->first.sender == header.sender;
  if (!same) {
    StreamKey key{std::string(channel), std::string(header.sender), header.instance};
    if (rows_.size() >= kMaxStreams && !rows_.contains(key)) {
      ++streams_left_out_;
      return;
    }
    last_ = &*rows_.try_emplace(std::move(key)).first;
  }
  last_->second.heard_utime = now;
  counter_.count(channel, header.sender, header.instance, header.seq, header.utime);
  // Commands may have a time in the future, measurements may not.
  const double ahead = units::seconds(saturatedDifference(header.utime, now));
  if (ahead > kClockAhead && seqCountsMessages(channel) && ahead_.size() < kMaxNames) {
    ahead_[last_->first.sender] = ahead;
  } else if (!ahead_.empty() && ahead < kClockAhead / 2) {
    ahead_.erase(last_->first.sender);
  }
}

void HealthView::countNotUnderstood(std::string_view channel, std::int64_t count) {
  std::string name(channel);
  if (not_understood_.size() >= kMaxNames && !not_understood_.contains(name)) return;
  not_understood_[std::move(name)] += count;
}

void HealthView::take(const service_status_t& status, std::int64_t now) {
  const std::pair key{status.sender, status.host};
  const auto found = services_.find(key);
  if (found == services_.end()) {
    // Commands of the terminal only send a last status with their counts; they are not services.
    if (status.state == service_status_t::ENDED) return;
    if (services_.size() < kMaxServices) services_[key] = {status, now};
    return;
  }
  ServiceRow& row = found->second;
  if (status.instance < row.status.instance) return;  // from the previous process, which is ending
  if (status.instance > row.status.instance) ++row.starts;
  row.status = status;
  row.heard_utime = now;
}

void HealthView::take(const tracker_status_t& status, std::int64_t now) {
  tracker_ = status;
  tracker_utime_ = now;
}

void HealthView::take(const link_status_t& status, std::int64_t) {
  if (links_.size() < kMaxNames || links_.contains(status.host)) links_[status.host] = status;
}

void HealthView::tick(std::int64_t) {
  for (auto& [key, row] : rows_) {
    const StreamCount& stream = counter_.streams().at(key);
    const auto slot = static_cast<std::size_t>(row.ticks % static_cast<int>(row.received.size()));
    const auto seconds = std::min<std::int64_t>(row.ticks, static_cast<int>(row.received.size()));
    // At the first tick the time since the first message is unknown.
    if (seconds > 0) {
      const bool full = row.ticks >= static_cast<int>(row.received.size());
      const std::size_t oldest = full ? slot : 0;
      row.rate = static_cast<double>(stream.received - row.received[oldest]) /
                 static_cast<double>(seconds);
      row.new_losses = stream.lost - row.lost[oldest];
    }
    row.received[slot] = stream.received;
    row.lost[slot] = stream.lost;
    ++row.ticks;
  }
  if (tracker_ && tracker_before_ && tracker_->instance == tracker_before_->instance) {
    new_saturated_ = tracker_->saturated - tracker_before_->saturated;
    new_dark_ = tracker_->dark - tracker_before_->dark;
  }
  tracker_before_ = tracker_;
}

void HealthView::clear() { *this = HealthView(); }

std::vector<std::int32_t> HealthView::pids(const std::string& host) const {
  std::vector<std::int32_t> pids;
  for (const auto& [key, row] : services_) {
    if (isOurs(row, host) && !row.hasEnded()) {
      pids.push_back(row.status.pid);
    }
  }
  return pids;
}

Json HealthView::servicesJson(std::int64_t now, const std::string& host,
                              const std::map<std::int32_t, ProcessUse>& uses) const {
  Json json = Json::array();
  for (const auto& [key, row] : services_) {
    const service_status_t& status = row.status;
    std::int64_t lost = 0;
    std::int64_t decode_errors = 0;
    for (const stream_count_t& stream : status.received) {
      lost += stream.lost;
      decode_errors += stream.decode_errors;
    }
    const auto use = isOurs(row, host) ? uses.find(status.pid) : uses.end();
    const bool used = use != uses.end();
    const std::int64_t until = row.hasEnded() ? row.heard_utime : now;
    json.push_back({{"name", status.sender},
                    {"state", stateName(status.state)},
                    {"origin", status.origin},
                    {"host", status.host},
                    {"pid", status.pid},
                    {"version", status.version},
                    {"starts", row.starts},
                    {"uptime_s", number(units::seconds(until - status.start_utime))},
                    {"age_s", age(row.heard_utime, now)},
                    {"cpu_percent", used ? number(use->second.cpu_percent) : Json()},
                    {"memory_MB", used ? number(use->second.memory_MB) : Json()},
                    {"last_error", status.last_error},
                    {"lost", lost},
                    {"decode_errors", decode_errors}});
  }
  return json;
}

Json HealthView::streamsJson(std::int64_t now) const {
  Json json = Json::array();
  for (const auto& [key, row] : rows_) {
    const StreamCount& stream = counter_.streams().at(key);
    json.push_back({{"channel", key.channel},
                    {"sender", key.sender},
                    {"rate_Hz", number(row.rate)},
                    {"age_s", age(row.heard_utime, now)},
                    {"received", stream.received},
                    {"lost", stream.lost}});
  }
  return json;
}

Json HealthView::json(std::int64_t now, const std::string& host,
                      const std::map<std::int32_t, ProcessUse>& uses) const {
  Json not_understood = Json::array();
  for (const auto& [channel, messages] : not_understood_) {
    not_understood.push_back({{"channel", channel}, {"messages", messages}});
  }
  return {{"services", servicesJson(now, host, uses)},
          {"streams", streamsJson(now)},
          {"streams_left_out", streams_left_out_},
          {"not_understood", std::move(not_understood)},
          {"tracker", tracker_ ? trackerJson(*tracker_, tracker_utime_, now) : Json()},
          {"links", linksJson(links_)}};
}

}  // namespace lab::dashboard
