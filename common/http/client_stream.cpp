#include "common/http/client_stream.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace lab {

using namespace std::chrono_literals;

bool waitForSocket(int socket, short events, ClientStream::Clock::time_point deadline) {
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - ClientStream::Clock::now());
    pollfd entry{socket, events, 0};
    const int found = poll(&entry, 1, static_cast<int>(std::max(0ms, left).count()));
    if (found > 0) return true;
    if (found == 0 || errno != EINTR) return false;
  }
}

ClientStream::ClientStream(int socket, std::size_t limit, Clock::duration timeout)
    : socket_(socket), timeout_(timeout), deadline_(Clock::now() + timeout), left_(limit) {}

std::size_t ClientStream::read(std::span<char> bytes) {
  if (left_ == 0) limit_reached_ = true;
  const std::size_t size = std::min(bytes.size(), left_);
  if (size == 0) return 0;
  while (waitForSocket(socket_, POLLIN, deadline_)) {
    const ssize_t count = recv(socket_, bytes.data(), size, MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) return 0;
    has_read_ = true;
    left_ -= static_cast<std::size_t>(count);
    return static_cast<std::size_t>(count);
  }
  return 0;
}

bool ClientStream::write(std::string_view bytes) {
  has_written_ = true;
  const auto deadline = Clock::now() + timeout_;
  while (!bytes.empty()) {
    const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      if (!waitForSocket(socket_, POLLOUT, deadline)) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

void ClientStream::finish() {
  constexpr std::size_t kMaxDiscarded = 1 << 20;
  std::array<char, 4096> discarded{};
  shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + 300ms;
  for (std::size_t total = 0; total < kMaxDiscarded;) {
    if (!waitForSocket(socket_, POLLIN, deadline)) return;
    const ssize_t count = recv(socket_, discarded.data(), discarded.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return;
    if (count > 0) total += static_cast<std::size_t>(count);
  }
}

bool ClientStream::isOpen() const {
  pollfd entry{socket_, POLLOUT | POLLRDHUP, 0};
  if (poll(&entry, 1, 0) < 0) return false;
  return (entry.revents & (POLLERR | POLLHUP | POLLRDHUP | POLLNVAL)) == 0;
}

}  // namespace lab
