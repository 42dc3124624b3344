/// Joins the bus of this host with those of other hosts over reliable DDS (docs/link.md).
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
  std::string host;                ///< unique name of this host
  std::string address;             ///< of the interface to use
  std::vector<std::string> peers;  ///< addresses of the other hosts
  std::string key;                 ///< key of the run: separates runs
  int domain = 77;                 ///< of DDS
  std::string security;            ///< folder of certificates, empty: none
  double max_offset = 0.005;       ///< [s] between two clocks, see Link::max_clock_offset
  /// Returns the time [us since 1970]; empty: the loop's clock. Tests shift it.
  std::function<std::int64_t()> clock = {};
  /// Version of the messages of this end. Tests set another one.
  ProtocolVersion protocol = ProtocolVersion::own();
};

/// Forwards the messages of the lab's programs on this host, and publishes those of the other
/// hosts: unchanged, in the order of each stream. Publishes LINK_STATUS once a second and on
/// change, and reports errors in the heartbeat. Works on the loop's thread; a write blocks for at
/// most 10 ms, whatever the state of the peers.
class BusLink {
 public:
  /// The arguments outlive the link.
  /// @throws dds::DdsError
  BusLink(Node& node, Loop& loop, DescriptorWatcher& descriptors, const BusLinkOptions& options);
  ~BusLink();
  BusLink(const BusLink&) = delete;
  BusLink& operator=(const BusLink&) = delete;

  /// Call it after Node::close(): whether the last message of the node is still on its way from the
  /// bus to the readers of the other hosts. From the first call on, the link publishes nothing
  /// itself.
  [[nodiscard]] bool isForwarding();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab::gateway
