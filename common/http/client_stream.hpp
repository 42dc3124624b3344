/// A TCP connection between a client and a server, with limits on time and on bytes.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <string_view>

namespace lab {

/// Reads and writes one connection with blocking calls. Everything that is read must arrive within
/// the timeout after construction and within the limit of bytes; each write must finish within the
/// timeout. Does not own the socket, which must be non-blocking. ::shutdown() of the socket from
/// another thread ends every wait.
class ClientStream {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::seconds kTimeout{10};
  static constexpr std::size_t kMaxHead = 16384;  ///< bytes of request line and headers

  explicit ClientStream(int socket, std::size_t limit = kMaxHead,
                        Clock::duration timeout = kTimeout);

  /// Raises the limit of bytes that may be read, for a body.
  void allow(std::size_t bytes) { left_ += bytes; }

  /// Reads what has arrived, at least one byte, or waits for it.
  /// @return the number of bytes; 0 at the end of the stream, on errors, after the timeout and when
  ///         the limit is reached
  [[nodiscard]] std::size_t read(std::span<char> bytes);

  /// Writes all of it. @return false on errors and after the timeout
  bool write(std::string_view bytes);

  /// Closes the sending direction, then reads and discards for up to 300 ms what the other end
  /// still sends. A socket that is closed with unread bytes sends a reset, which can destroy the
  /// response before the client has read it.
  void finish();

  /// Whether the other end has neither closed the connection nor stopped sending.
  [[nodiscard]] bool isOpen() const;

  [[nodiscard]] bool limitReached() const {
    return limit_reached_;
  }                                                         ///< by an attempt to read more
  [[nodiscard]] bool hasRead() const { return has_read_; }  ///< at least one byte
  [[nodiscard]] bool hasWritten() const { return has_written_; }
  [[nodiscard]] int socket() const { return socket_; }

 private:
  int socket_;
  Clock::duration timeout_;
  Clock::time_point deadline_;
  std::size_t left_;
  bool limit_reached_ = false;
  bool has_read_ = false;
  bool has_written_ = false;
};

/// Waits until a poll() event of `events` occurs on the socket. Errors of the socket count as
/// events. @return false when the deadline passes first
[[nodiscard]] bool waitForSocket(int socket, short events,
                                 ClientStream::Clock::time_point deadline);

}  // namespace lab
