#include "analyzer/report/record/link_records.hpp"

#include <cmath>
#include <cstddef>

namespace lab::report {
namespace {

constexpr std::size_t kMostLinks = 1000;

/// Adds the counts of one start of both gateways to those of earlier starts.
void addCounts(const link_peer_t& peer, std::int64_t timeouts, LinkRecord& record) {
  record.received += peer.received;
  record.lost += peer.lost;
  record.repeated += peer.repeated;
  record.stale += peer.stale;
  record.clashing += peer.clashing;
  record.timeouts += timeouts;
}

}  // namespace

void LinkRecords::take(const link_status_t& status) {
  for (const link_peer_t& peer : status.peers) {
    if (watched_.size() >= kMostLinks && !watched_.contains({status.host, peer.host})) continue;
    Watched& watched = watched_[{status.host, peer.host}];
    LinkRecord& record = watched.record;
    record.host = status.host;
    record.peer = peer.host;
    // A restart of either gateway resets the counts.
    if (status.instance != watched.instance || peer.received < watched.last.received) {
      addCounts(watched.last, watched.timeouts, record);
    }
    watched.instance = status.instance;
    watched.last = peer;
    watched.timeouts = status.timeouts;
    const bool joined = peer.state == link_peer_t::JOINED;
    if (watched.joined && !joined) ++record.interruptions;
    watched.joined = joined;
    if (!peer.trouble.empty()) record.trouble = peer.trouble;
    if (std::isfinite(peer.round_trip)) record.round_trip = peer.round_trip;
    record.lowest_offset = std::fmin(record.lowest_offset, peer.clock_offset);
    record.highest_offset = std::fmax(record.highest_offset, peer.clock_offset);
  }
}

std::vector<LinkRecord> LinkRecords::records() const {
  std::vector<LinkRecord> all;
  for (const auto& [hosts, watched] : watched_) {
    LinkRecord& record = all.emplace_back(watched.record);
    addCounts(watched.last, watched.timeouts, record);
  }
  return all;
}

}  // namespace lab::report
