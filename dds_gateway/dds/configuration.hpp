/// Cyclone DDS configurations, as XML. What is not one of these is the user's own file.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dds {

/// What a folder of certificates holds (docs/security.md), as networkConfiguration() reads it.
inline constexpr std::array<std::string_view, 6> kSecurityFiles{
    "identity_ca.pem",    "cert.pem",       "key.pem",
    "permissions_ca.pem", "governance.p7s", "permissions.p7s"};

/// Nothing leaves this machine, and nobody elsewhere is heard. ROS 2 on this machine is met where
/// it uses the loopback interface (Humble's ROS_LOCALHOST_ONLY, the files of docs/examples/ros2);
/// beside a network card not with its defaults, nor with Jazzy's LOCALHOST, whose nodes are at the
/// card's address (docs/ros2.md).
[[nodiscard]] std::string localConfiguration();

struct NetworkOptions {
  std::string address = {};             ///< of the interface to use
  std::vector<std::string> peers = {};  ///< addresses of hosts that multicast does not reach
  bool multicast = true;                ///< hosts on the same network are found by multicast
  std::string security = {};            ///< folder of certificates (docs/security.md), empty: none
  /// Writers go on while a reader takes nothing, as far as their depth goes. Otherwise 500 kB that
  /// are not acknowledged make each write wait its max_blocking_time.
  bool unthrottled_writers = false;
};

/// One named interface: multicast for discovery at most, data unicast, no message above one
/// Ethernet frame.
/// @throws DdsError when an address is none, or the folder of certificates lacks a file.
[[nodiscard]] std::string networkConfiguration(const NetworkOptions& options);

}  // namespace lab::dds
