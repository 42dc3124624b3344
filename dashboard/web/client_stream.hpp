/// One client's connection, as cpp-httplib reads and writes it, with limits that it lacks.
#pragma once

#include <httplib.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <string>

namespace lab::dashboard {

/// Everything a client sends must have come within kTimeout of the start and within the limit of
/// bytes; what is written must go out within kTimeout a piece. Does not own the socket, which must
/// not block; ::shutdown() of it ends every wait.
class ClientStream final : public httplib::Stream {
 public:
  static constexpr std::chrono::seconds kTimeout{10};
  static constexpr std::size_t kMostHead = 16384;  ///< bytes of request line and headers

  explicit ClientStream(int socket);

  /// Lets so many bytes more be read: a body.
  void allow(std::size_t bytes) { left_ += bytes; }

  [[nodiscard]] bool exhausted() const { return exhausted_; }  ///< more came than was allowed
  [[nodiscard]] bool heard() const { return heard_; }          ///< anything at all
  [[nodiscard]] bool wrote() const { return wrote_; }

  /// Says that no more comes and reads what the client still sends, for a moment: a socket closed
  /// with unread bytes would take the answer back.
  void finish();

  bool is_readable() const override;
  /// False too when the client has gone.
  bool is_writable() const override;
  ssize_t read(char* bytes, size_t size) override;
  ssize_t write(const char* bytes, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  int socket_;
  Clock::time_point deadline_ = Clock::now() + kTimeout;
  std::size_t left_ = kMostHead;
  bool exhausted_ = false;
  bool heard_ = false;
  bool wrote_ = false;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace lab::dashboard
