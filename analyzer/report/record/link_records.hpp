/// Statistics of the links between hosts.
#pragma once

#include <cstdint>
#include <lab/link_status_t.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/math/units.hpp"

namespace lab::report {

/// The statistics of one host about another, over the run and all starts of their gateways.
struct LinkRecord {
  std::string host;  ///< the host that reported
  std::string peer;
  std::int64_t received = 0;
  std::int64_t lost = 0;
  std::int64_t repeated = 0;
  std::int64_t stale = 0;     ///< commands that arrived too late
  std::int64_t clashing = 0;  ///< messages of a sender that also reaches this host from another one
  std::int64_t timeouts = 0;  ///< messages that DDS could not send, to any host
  int interruptions = 0;      ///< number of times that the link broke
  double lowest_offset = units::kNan;   ///< [s] clock of the peer minus clock of the host
  double highest_offset = units::kNan;  ///< [s]
  double round_trip = units::kNan;      ///< [s] as last reported
  std::string trouble;                  ///< last reported problem
};

/// Collects LINK_STATUS.
class LinkRecords {
 public:
  void take(const link_status_t& status);

  /// In order of host and peer.
  [[nodiscard]] std::vector<LinkRecord> records() const;

 private:
  struct Watched {
    LinkRecord record;  ///< sums of earlier starts of the gateways
    link_peer_t last{};
    std::int64_t instance = 0;
    std::int64_t timeouts = 0;
    bool joined = false;
  };
  std::map<std::pair<std::string, std::string>, Watched> watched_;
};

}  // namespace lab::report
