/// How the buses of several hosts fared.
#pragma once

#include <cstdint>
#include <lab/link_status_t.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/math/units.hpp"

namespace lab::report {

/// One host's view of another, over the run and all starts of their gateways.
struct LinkRecord {
  std::string host;  ///< that says so
  std::string peer;
  std::int64_t received = 0;
  std::int64_t lost = 0;
  std::int64_t repeated = 0;
  std::int64_t stale = 0;               ///< commands that came too late
  std::int64_t clashing = 0;            ///< of a sender that another host brings
  std::int64_t timeouts = 0;            ///< that DDS could not take, to any host
  int interruptions = 0;                ///< how often it was joined and then was not
  double lowest_offset = units::kNan;   ///< [s] its clock minus ours
  double highest_offset = units::kNan;  ///< [s]
  double round_trip = units::kNan;      ///< [s] as said last
  std::string trouble;                  ///< as said last that was any
};

/// Collects LINK_STATUS.
class LinkRecords {
 public:
  void take(const link_status_t& status);

  /// In order of host and peer.
  [[nodiscard]] std::vector<LinkRecord> records() const;

 private:
  struct Watched {
    LinkRecord record;  ///< of earlier starts of the gateways
    link_peer_t last{};
    std::int64_t instance = 0;
    std::int64_t timeouts = 0;
    bool joined = false;
  };
  std::map<std::pair<std::string, std::string>, Watched> watched_;
};

}  // namespace lab::report
