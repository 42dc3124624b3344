/// Keeps unicast datagrams away from stock LCM programs on a bus, such as an lcm-logger of the
/// user.
#pragma once

#include <cstdint>
#include <map>

#include "common/bus/refused_datagrams.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab {

/// LCM 1.3.1 binds to any address, so programs of any network can send to lcm-logger by unicast.
/// The kernel gives a unicast datagram to a socket that is bound to its very address first
/// (__udp4_lib_lookup() in net/ipv4/udp.c); this class has one for each address of this machine.
/// Multicast and broadcast still reach lcm-logger. Nothing in a lab sends unicast to the bus.
class UnicastSink {
 public:
  /// @param port of the bus
  explicit UnicastSink(std::uint16_t port) : port_(port) { update(); }

  /// Counts what has come, and adds addresses that this machine has got since. Call it about once
  /// a second.
  void update();

  [[nodiscard]] const RefusedDatagrams& refused() const { return refused_; }

 private:
  void cover(std::uint32_t address);

  std::uint16_t port_;
  std::map<std::uint32_t, FileDescriptor> sockets_;  ///< by address
  RefusedDatagrams refused_;
};

}  // namespace lab
