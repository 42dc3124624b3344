/// An HTTP client that sends arbitrary bytes, including invalid requests.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace lab::dashboard {

class RawClient {
 public:
  /// @param receive_buffer size [byte]; 0 for the default of the system
  /// @param address in network byte order
  explicit RawClient(int port, int receive_buffer = 0, in_addr_t address = htonl(INADDR_LOOPBACK))
      : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_buffer > 0) {
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    }
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    place.sin_addr.s_addr = address;
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&place), sizeof place) == 0;
  }
  ~RawClient() {
    if (socket_ >= 0) close(socket_);
  }
  RawClient(RawClient&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), connected_(other.connected_) {}
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }

  void send(std::string_view text) {
    while (!text.empty()) {
      const ssize_t count = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (count <= 0) return;  // the server has closed the connection
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  /// Closes the sending direction.
  void endSending() { shutdown(socket_, SHUT_WR); }

  /// Receives until the received bytes contain `text`, the server closes, or the timeout is over.
  /// @return all bytes received so far
  const std::string& receive(std::string_view text,
                             std::chrono::milliseconds timeout = std::chrono::seconds(30)) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    std::array<char, 65536> piece{};
    while (text.empty() || received_.find(text) == std::string::npos) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      pollfd place{socket_, POLLIN, 0};
      if (left.count() <= 0 || poll(&place, 1, static_cast<int>(left.count())) <= 0) break;
      const ssize_t count = recv(socket_, piece.data(), piece.size(), 0);
      if (count <= 0) break;
      received_.append(piece.data(), static_cast<std::size_t>(count));
    }
    return received_;
  }

  /// Receives until the server closes the connection.
  const std::string& receiveAll() { return receive({}); }

 private:
  int socket_;
  bool connected_ = false;
  std::string received_;
};

/// Sends a request. @return the complete response
inline std::string exchange(int port, std::string_view request) {
  RawClient client(port);
  client.send(request);
  return client.receiveAll();
}

/// The status of a response: "403" for "HTTP/1.1 403 Forbidden ...".
inline std::string statusOf(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : "none";
}

}  // namespace lab::dashboard
