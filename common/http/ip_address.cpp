#include "common/http/ip_address.hpp"

#include <netdb.h>
#include <sys/socket.h>

#include <array>

namespace lab {
namespace {

using AddressFunction = int (*)(int, sockaddr*, socklen_t*);

SocketAddress addressBy(AddressFunction function, int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  if (function(socket, plain, &size) != 0 ||
      (plain->sa_family != AF_INET && plain->sa_family != AF_INET6) ||
      getnameinfo(plain, size, host.data(), host.size(), service.data(), service.size(),
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return {};
  }
  return {host.data(), std::stoi(service.data())};
}

}  // namespace

std::string_view withoutMappedPrefix(std::string_view address) {
  constexpr std::string_view kMapped = "::ffff:";
  const bool dotted = address.find('.') != std::string_view::npos;
  if (address.starts_with(kMapped) && dotted) address.remove_prefix(kMapped.size());
  return address;
}

bool isLoopback(std::string_view address) {
  address = withoutMappedPrefix(address);
  return address.starts_with("127.") || address == "::1";
}

SocketAddress peerAddress(int socket) { return addressBy(getpeername, socket); }

SocketAddress localAddress(int socket) { return addressBy(getsockname, socket); }

}  // namespace lab
