/// The lab's Cyclone DDS configurations, as XML.
#pragma once

#include <string>
#include <vector>

namespace lab::dds {

/// Uses the loopback interface only: nothing leaves this machine or is received from others. Finds
/// ROS 2 nodes on this machine that use the loopback interface (Humble's ROS_LOCALHOST_ONLY, the
/// files of docs/examples/ros2). On a machine with a network card it does not find nodes with ROS
/// 2's defaults, nor with Jazzy's LOCALHOST, whose nodes use the card's address (docs/ros2.md).
[[nodiscard]] std::string localConfiguration();

struct NetworkOptions {
  std::string address = {};             ///< address of the interface to use
  std::vector<std::string> peers = {};  ///< addresses of hosts that multicast does not reach
  bool multicast = true;                ///< finds hosts on the same network by multicast
  std::string security = {};            ///< folder of certificates (docs/security.md), empty: none
  /// Writers continue, up to their depth, while a reader does not acknowledge. Otherwise 500 kB of
  /// unacknowledged data make each write block for max_blocking_time.
  bool unthrottled_writers = false;
};

/// Uses one interface: multicast only for discovery, data by unicast, no message larger than an
/// Ethernet frame.
/// @throws DdsError if an address is invalid, or the folder of certificates cannot be used
[[nodiscard]] std::string networkConfiguration(const NetworkOptions& options);

}  // namespace lab::dds
