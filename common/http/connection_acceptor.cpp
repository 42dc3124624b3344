#include "common/http/connection_acceptor.hpp"

#include <fmt/format.h>
#include <linux/sockios.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/http/ip_address.hpp"

namespace lab {
namespace {

constexpr int kBacklog = 128;
// Threads beyond max_connections: those that are being refused or shut down.
constexpr int kExtraThreads = 8;
constexpr std::chrono::milliseconds kStalled{1000};

std::string errorText(int error) {
  return std::error_code(error, std::generic_category()).message();
}

/// @return the socket, or -1 with errno
int listenAt(const addrinfo& endpoint) {
  const int socket = ::socket(endpoint.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return -1;
  const int yes = 1;
  // Without SO_REUSEADDR a port stays taken for a minute after its connections have ended. Unlike
  // SO_REUSEPORT it does not let two servers share a port.
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(socket, endpoint.ai_addr, endpoint.ai_addrlen) == 0 && listen(socket, kBacklog) == 0) {
    return socket;
  }
  const int error = errno;
  ::close(socket);
  errno = error;
  return -1;
}

/// For how long the client has taken nothing of what waits to be sent; 0 if nothing waits.
std::chrono::milliseconds stalledFor(int socket) {
  int waiting = 0;  // [byte]
  tcp_info info{};
  socklen_t size = sizeof info;
  if (ioctl(socket, SIOCOUTQ, &waiting) != 0 || waiting == 0 ||
      getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) {
    return std::chrono::milliseconds(0);
  }
  return std::chrono::milliseconds(info.tcpi_last_data_sent);
}

}  // namespace

ConnectionAcceptor::ConnectionAcceptor(ListenOptions options) : options_(std::move(options)) {
  const auto& [owner, address, port, ports_tried, max_connections, max_remote, send_buffer] =
      options_;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  int error = 0;
  for (int tried = port; listener_ < 0 && tried < port + ports_tried && tried <= 65535; ++tried) {
    addrinfo* endpoint = nullptr;
    if (getaddrinfo(address.c_str(), std::to_string(tried).c_str(), &hints, &endpoint) != 0) {
      throw std::runtime_error(fmt::format(
          "{}: found the address {}, expected a numeric one such as 127.0.0.1", owner, address));
    }
    listener_ = listenAt(*endpoint);
    error = errno;
    freeaddrinfo(endpoint);
    if (listener_ < 0 && error != EADDRINUSE && error != EACCES) break;
  }
  if (listener_ < 0 && (error != EADDRINUSE || ports_tried == 1)) {
    throw std::runtime_error(
        fmt::format("{}: cannot listen on {}:{} ({}); choose a free port above 1023 and an address "
                    "of this host",
                    owner, address, port, errorText(error)));
  }
  if (listener_ < 0) {
    throw std::runtime_error(fmt::format("{}: on {} no port from {} to {} is free", owner, address,
                                         port, port + ports_tried - 1));
  }
  port_ = localAddress(listener_).port;
}

ConnectionAcceptor::~ConnectionAcceptor() {
  close();
  if (listener_ >= 0) ::close(listener_);
}

void ConnectionAcceptor::open(Serve serve) {
  serve_ = std::move(serve);
  accepting_ = std::thread([this] { acceptAll(); });
}

void ConnectionAcceptor::close() {
  if (!accepting_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  left_.notify_all();
  wakeup_.signal();
  accepting_.join();
  {
    std::unique_lock lock(mutex_);
    for (const auto& [socket, connection] : connections_) shutdown(socket, SHUT_RDWR);
    left_.wait(lock, [this] { return connections_.empty(); });
  }
  joinFinished();
}

void ConnectionAcceptor::acceptAll() {
  const auto most = static_cast<std::size_t>(options_.max_connections + kExtraThreads);
  while (!closing_) {
    joinFinished();
    {
      std::unique_lock lock(mutex_);
      left_.wait(lock, [&] { return closing_ || connections_.size() < most; });
    }
    std::array<pollfd, 2> entries{pollfd{listener_, POLLIN, 0}, pollfd{wakeup_.get(), POLLIN, 0}};
    poll(entries.data(), entries.size(), -1);
    if (closing_) return;
    const int socket = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (socket < 0) {
      // E.g. no file descriptors are left: wait before the next attempt.
      if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED) poll(&entries[1], 1, 100);
      continue;
    }
    const int yes = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (options_.send_buffer > 0) {
      setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &options_.send_buffer, sizeof options_.send_buffer);
    }
    start(socket, !isLoopback(peerAddress(socket).ip));
  }
}

void ConnectionAcceptor::start(int socket, bool remote) {
  const std::lock_guard lock(mutex_);
  const bool has_place = hasPlaceFor(remote);
  try {
    Connection& connection = connections_[socket];
    connection.since = std::chrono::steady_clock::now();
    connection.remote = remote;
    connection.thread = std::thread([this, socket, has_place] {
      serve_(socket, has_place && !closing_);
      leave(socket);
    });
  } catch (const std::exception&) {  // no memory or no thread is left
    connections_.erase(socket);
    ::close(socket);
  }
}

bool ConnectionAcceptor::hasPlaceFor(bool remote) {
  const auto is_remote = [](const auto& entry) { return entry.second.remote; };
  const bool too_many_remote =
      remote && std::ranges::count_if(connections_, is_remote) >= options_.max_remote;
  const auto places = static_cast<std::size_t>(options_.max_connections);
  if (connections_.size() < places && !too_many_remote) return true;
  const auto chosen = leastNeeded(too_many_remote);
  if (chosen == connections_.end()) return false;
  shutdown(chosen->first, SHUT_RDWR);
  chosen->second.ending = true;
  return true;
}

/// The connection to shut down for another client, end() if all are needed.
std::map<int, ConnectionAcceptor::Connection>::iterator ConnectionAcceptor::leastNeeded(
    bool only_remote) {
  // Connections from other hosts are shut down first.
  const auto goes_before = [](const Connection& one, const Connection& other) {
    return one.remote != other.remote ? one.remote : one.since < other.since;
  };
  auto unknown = connections_.end();
  auto stalled = connections_.end();
  auto longest = kStalled;
  for (auto entry = connections_.begin(); entry != connections_.end(); ++entry) {
    const Connection& connection = entry->second;
    if (connection.ending || (only_remote && !connection.remote)) continue;
    if (!connection.identified) {
      if (unknown == connections_.end() || goes_before(connection, unknown->second)) {
        unknown = entry;
      }
    } else if (const auto time = stalledFor(entry->first); time >= longest) {
      longest = time;
      stalled = entry;
    }
  }
  return unknown != connections_.end() ? unknown : stalled;
}

void ConnectionAcceptor::identify(int socket) {
  const std::lock_guard lock(mutex_);
  const auto entry = connections_.find(socket);
  if (entry != connections_.end()) entry->second.identified = true;
}

void ConnectionAcceptor::leave(int socket) {
  {
    const std::lock_guard lock(mutex_);
    finished_.push_back(std::move(connections_[socket].thread));
    connections_.erase(socket);
    ::close(socket);  // under the lock: the system may give its number to the next connection
  }
  left_.notify_all();
}

void ConnectionAcceptor::joinFinished() {
  std::vector<std::thread> finished;
  {
    const std::lock_guard lock(mutex_);
    finished.swap(finished_);
  }
  for (std::thread& thread : finished) thread.join();
}

}  // namespace lab
