#include "dashboard/web/connection_acceptor.hpp"

#include <fmt/format.h>
#include <httplib.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "dashboard/web/http_guard.hpp"

namespace lab::dashboard {
namespace {

constexpr int kPortsTried = 100;
constexpr int kBacklog = 128;
// Beyond kMost: who is turned out may not have gone when the next one is there.
constexpr int kThreads = ConnectionAcceptor::kMost + 8;
// What a client that reads slowly may have waiting in the kernel; more would be old news.
constexpr int kSendBuffer = 128 * 1024;

std::string reason(int error) { return std::error_code(error, std::generic_category()).message(); }

/// @return the socket, or -1 with errno.
int listenAt(const addrinfo& place) {
  const int socket = ::socket(place.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return -1;
  const int yes = 1;
  // Without it, a port whose connections ended just now is not free. Two servers on one port, which
  // SO_REUSEPORT allows, it does not.
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(socket, place.ai_addr, place.ai_addrlen) == 0 && listen(socket, kBacklog) == 0) {
    return socket;
  }
  const int error = errno;
  ::close(socket);
  errno = error;
  return -1;
}

int portOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXSERV> service{};
  if (getsockname(socket, plain, &size) != 0 ||
      getnameinfo(plain, size, nullptr, 0, service.data(), service.size(), NI_NUMERICSERV) != 0) {
    return 0;
  }
  return std::stoi(service.data());
}

bool isRemote(const sockaddr_storage& peer, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  const auto* const plain = reinterpret_cast<const sockaddr*>(&peer);
  return getnameinfo(plain, size, host.data(), host.size(), nullptr, 0, NI_NUMERICHOST) != 0 ||
         !isLoopback(host.data());
}

}  // namespace

ConnectionAcceptor::ConnectionAcceptor(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  int error = 0;
  for (int tried = port; listener_ < 0 && tried < port + kPortsTried && tried <= 65535; ++tried) {
    addrinfo* place = nullptr;
    if (getaddrinfo(address.c_str(), std::to_string(tried).c_str(), &hints, &place) != 0) {
      throw std::runtime_error(
          fmt::format("dashboard: found the address {}, expected a number as 127.0.0.1", address));
    }
    listener_ = listenAt(*place);
    error = errno;
    freeaddrinfo(place);
    if (listener_ < 0 && error != EADDRINUSE && error != EACCES) break;
  }
  if (listener_ < 0 && error != EADDRINUSE) {
    throw std::runtime_error(
        fmt::format("dashboard: cannot listen on {}:{} ({}); give an address of this machine and "
                    "a port above 1023",
                    address, port, reason(error)));
  }
  if (listener_ < 0) {
    throw std::runtime_error(fmt::format("dashboard: on {} no port from {} to {} is free", address,
                                         port, port + kPortsTried - 1));
  }
  port_ = portOf(listener_);
  wakeup_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
}

ConnectionAcceptor::~ConnectionAcceptor() {
  close();
  if (listener_ >= 0) ::close(listener_);
  if (wakeup_ >= 0) ::close(wakeup_);
}

void ConnectionAcceptor::open(Serve serve) {
  serve_ = std::move(serve);
  threads_ = std::make_unique<httplib::ThreadPool>(kThreads);
  accepting_ = std::thread([this] { acceptAll(); });
}

void ConnectionAcceptor::close() {
  if (!accepting_.joinable()) return;
  closing_ = true;
  eventfd_write(wakeup_, 1);
  accepting_.join();
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [socket, guest] : connections_) shutdown(socket, SHUT_RDWR);
  }
  threads_->shutdown();
}

void ConnectionAcceptor::acceptAll() {
  while (!closing_) {
    std::array<pollfd, 2> places{pollfd{listener_, POLLIN, 0}, pollfd{wakeup_, POLLIN, 0}};
    poll(places.data(), places.size(), -1);
    if (closing_) return;
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    const int socket =
        accept4(listener_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (socket < 0) {
      // Out of descriptors, say: not to be asked again at once.
      if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED) {
        poll(&places[1], 1, 100);
      }
      continue;
    }
    const int yes = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
    const bool room = enter(socket, isRemote(peer, size));
    threads_->enqueue([this, socket, room] {
      serve_(socket, room && !closing_);
      leave(socket);
    });
  }
}

bool ConnectionAcceptor::enter(int socket, bool far) {
  const std::lock_guard lock(mutex_);
  const auto is_far = [](const auto& guest) { return guest.second.far; };
  const bool too_many_far = far && std::ranges::count_if(connections_, is_far) >= kMostRemote;
  bool room = connections_.size() < kMost && !too_many_far;
  if (!room) {
    // Of other machines first.
    const auto goes_before = [](const Connection& one, const Connection& other) {
      return one.far != other.far ? one.far : one.since < other.since;
    };
    auto oldest = connections_.end();
    for (auto guest = connections_.begin(); guest != connections_.end(); ++guest) {
      if (guest->second.settled || (too_many_far && !guest->second.far)) continue;
      if (oldest == connections_.end() || goes_before(guest->second, oldest->second))
        oldest = guest;
    }
    if (oldest != connections_.end()) {
      shutdown(oldest->first, SHUT_RDWR);
      oldest->second.settled = true;  // not to be chosen again
      room = true;
    }
  }
  connections_[socket] = {std::chrono::steady_clock::now(), false, far};
  return room;
}

void ConnectionAcceptor::settled(int socket) {
  const std::lock_guard lock(mutex_);
  connections_[socket].settled = true;
}

void ConnectionAcceptor::leave(int socket) {
  const std::lock_guard lock(mutex_);
  connections_.erase(socket);
  ::close(socket);  // under the lock: its number is another's from here on
}

}  // namespace lab::dashboard
