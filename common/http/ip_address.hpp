/// Numeric IP addresses as text, and the two ends of a socket.
#pragma once

#include <string>
#include <string_view>

namespace lab {

/// An IPv4 address that an IPv6 socket reports as "::ffff:192.0.2.1", without that prefix.
[[nodiscard]] std::string_view withoutMappedPrefix(std::string_view address);

/// Whether it is in 127.0.0.0/8 or is ::1.
[[nodiscard]] bool isLoopback(std::string_view address);

struct SocketAddress {
  std::string ip;  ///< numeric, empty if unknown
  int port = 0;    ///< 0 if unknown
};

/// The address of the other end of a connected socket.
[[nodiscard]] SocketAddress peerAddress(int socket);

/// The address of this end of a socket.
[[nodiscard]] SocketAddress localAddress(int socket);

}  // namespace lab
