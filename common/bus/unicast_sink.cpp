#include "common/bus/unicast_sink.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <utility>

#include "common/bus/own_addresses.hpp"

namespace lab {
namespace {

constexpr int kMostPerUpdate = 10'000;  // of one address, so that a flood does not hold the caller

}  // namespace

void UnicastSink::update() {
  for (const std::uint32_t address : interfaceAddresses()) {
    if (!sockets_.contains(address)) cover(address);
  }
  for (const auto& [address, socket] : sockets_) {
    sockaddr_in from{};
    for (int i = 0; i < kMostPerUpdate; ++i) {
      socklen_t size = sizeof from;
      char nothing = 0;
      if (recvfrom(socket.get(), &nothing, 1, MSG_TRUNC, reinterpret_cast<sockaddr*>(&from),
                   &size) < 0) {
        break;
      }
      refused_.count(Refusal::kUnicast, {ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)});
    }
  }
}

/// Leaves out an address that cannot be covered, for example because it is just being removed; the
/// next update tries again.
void UnicastSink::cover(std::uint32_t address) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int share = 1;
  setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &share, sizeof share);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(port_);
  own.sin_addr.s_addr = htonl(address);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0) {
    sockets_.emplace(address, std::move(socket));
  }
}

}  // namespace lab
