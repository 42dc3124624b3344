/// Cyclone DDS configurations, as XML. What is not one of these is the user's own file.
#pragma once

#include <string>
#include <vector>

namespace lab::dds {

/// Nothing leaves this machine; every discovery setting of ROS 2 on this machine is met.
[[nodiscard]] std::string localConfiguration();

struct NetworkOptions {
  std::string address = {};             ///< of the interface to use
  std::vector<std::string> peers = {};  ///< addresses of hosts that multicast does not reach
  bool multicast = true;                ///< hosts on the same network are found by multicast
  std::string security = {};            ///< folder of certificates (docs/security.md), empty: none
  /// Writers go on while a reader takes nothing, as far as their depth goes. Otherwise 500 kB that
  /// are not acknowledged make each write wait its most_blocking.
  bool patient_writers = false;
};

/// One named interface: multicast for discovery at most, data unicast, no message above one
/// Ethernet frame.
/// @throws DdsError when an address is none, or the folder of certificates lacks a file.
[[nodiscard]] std::string networkConfiguration(const NetworkOptions& options);

}  // namespace lab::dds
