#include "dashboard/web/client_stream.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace lab::dashboard {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Whether the socket is ready for `events` before the deadline; errors count as ready.
bool waitFor(int socket, short events, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd place{socket, events, 0};
    const int found = poll(&place, 1, static_cast<int>(std::max(0ms, left).count()));
    if (found > 0) return true;
    if (found == 0 || errno != EINTR) return false;
  }
}

using AddressOf = int (*)(int, sockaddr*, socklen_t*);

void numericAddress(int socket, AddressOf which, std::string& ip, int& port) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  if (which(socket, plain, &size) != 0 ||
      getnameinfo(plain, size, host.data(), host.size(), service.data(), service.size(),
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    ip.clear();
    port = 0;
    return;
  }
  ip = host.data();
  port = std::stoi(service.data());
}

}  // namespace

ClientStream::ClientStream(int socket) : socket_(socket) {}

bool ClientStream::is_readable() const {
  return begin_ < end_ || waitFor(socket_, POLLIN, deadline_);
}

bool ClientStream::is_writable() const {
  pollfd place{socket_, POLLOUT | POLLRDHUP, 0};
  if (poll(&place, 1, 0) < 0) return false;
  return (place.revents & (POLLERR | POLLHUP | POLLRDHUP | POLLNVAL)) == 0;
}

ssize_t ClientStream::read(char* bytes, size_t size) {
  if (left_ == 0) exhausted_ = true;
  if (left_ == 0 || size == 0) return -1;
  while (begin_ == end_) {
    if (!waitFor(socket_, POLLIN, deadline_)) return -1;
    const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) return count;
    heard_ = true;
    begin_ = 0;
    end_ = static_cast<std::size_t>(count);
  }
  const std::size_t count = std::min({size, left_, end_ - begin_});
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), count, bytes);
  begin_ += count;
  left_ -= count;
  return static_cast<ssize_t>(count);
}

ssize_t ClientStream::write(const char* bytes, size_t size) {
  wrote_ = true;
  const auto deadline = Clock::now() + kTimeout;
  std::size_t sent = 0;
  while (sent < size) {
    const ssize_t count = send(socket_, bytes + sent, size - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      if (!waitFor(socket_, POLLOUT, deadline)) return -1;
    } else if (errno != EINTR) {
      return -1;
    }
  }
  return static_cast<ssize_t>(size);
}

void ClientStream::finish() {
  constexpr std::size_t kMost = 1 << 20;
  shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + 300ms;
  for (std::size_t thrown = 0; thrown < kMost;) {
    if (!waitFor(socket_, POLLIN, deadline)) return;
    const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return;
    if (count > 0) thrown += static_cast<std::size_t>(count);
  }
}

void ClientStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  numericAddress(socket_, getpeername, ip, port);
}

void ClientStream::get_local_ip_and_port(std::string& ip, int& port) const {
  numericAddress(socket_, getsockname, ip, port);
}

}  // namespace lab::dashboard
