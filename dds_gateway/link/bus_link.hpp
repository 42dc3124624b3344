/// This host's bus joined with those of others, over reliable DDS (docs/link.md).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/descriptor_watcher.hpp"
#include "common/loop/loop.hpp"
#include "common/service/node.hpp"
#include "dds_gateway/link/link_peers.hpp"

namespace lab::gateway {

struct BusLinkOptions {
  std::string host;                ///< this one's name, none other has it
  std::string address;             ///< of the interface to use
  std::vector<std::string> peers;  ///< addresses of the other hosts
  std::string key;                 ///< of the run: two runs never mix
  int domain = 77;                 ///< of DDS
  std::string security;            ///< folder of certificates, empty: none
  double most_offset = 0.005;      ///< [s] between two clocks, see Link::max_clock_offset
  /// Now [us since 1970], empty: the loop's. Tests shift it.
  std::function<std::int64_t()> clock = {};
  /// What this end speaks. Tests say another.
  ProtocolVersion edition = ProtocolVersion::own();
};

/// Passes on what the lab's programs of this host publish, and publishes what those of the other
/// hosts do: unchanged, in the order of each stream. Says how it fares in LINK_STATUS, once a
/// second and when that changes, and keeps the worst for the heartbeat. Works on the loop's thread;
/// a write waits for the network no longer than 10 ms, however the peers fare.
class BusLink {
 public:
  /// All of them outlive the link.
  /// @throws dds::DdsError
  BusLink(Node& node, Loop& loop, DescriptorWatcher& descriptors, const BusLinkOptions& options);
  ~BusLink();
  BusLink(const BusLink&) = delete;
  BusLink& operator=(const BusLink&) = delete;

  /// To be asked after Node::close(): whether what the node has said last is still on its way, from
  /// the bus to the readers of the other hosts. From the first call on the link says nothing
  /// itself.
  [[nodiscard]] bool isForwarding();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab::gateway
