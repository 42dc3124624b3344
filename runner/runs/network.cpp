#include "runner/runs/network.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/message_header.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
bool portIsFree(int port, Sharing sharing) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_fd < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const int share = sharing == Sharing::kShared ? 1 : 0;
  setsockopt(socket_fd, SOL_SOCKET, SO_REUSEADDR, &share, sizeof share);
  const bool free =
      bind(socket_fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(socket_fd);
  return free;
}

int choosePort(int wanted) {
  if (wanted != 0) return wanted;
  // The search starts at a port derived from the pid, so that labs that start together differ.
  constexpr int kPorts = kLastPort - kFirstPort + 1;
  for (int offset = 0; offset < kPorts; ++offset) {
    const int port = kFirstPort + (getpid() * 7 + offset) % kPorts;
    if (portIsFree(port)) return port;
  }
  throw UserError("no UDP port between 20000 and 59999 is free");
}

void refuseForeignTraffic(const std::string& url, int listen_ms) {
  LcmBus bus(url);
  std::string found;
  bus.subscribeAll([&found](const Packet& packet) {
    if (!found.empty()) return;
    const auto header = peekHeader(packet.data);
    found = std::string(packet.channel) + " from " +
            (header ? std::string(header->sender) : "a foreign program");
  });
  bus.drainFor(listen_ms);
  if (!found.empty()) {
    throw UserError("another program already sends on " + url + " (" + found +
                    "): stop it, or set another network.port in the experiment file");
  }
}

}  // namespace lab::runner
