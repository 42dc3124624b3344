/// Receives LCM's UDP multicast, in place of liblcm: only from sources that the URL opens the bus
/// to, with bounds on what is kept, and without trusting any byte.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/own_addresses.hpp"
#include "common/bus/refused_datagrams.hpp"
#include "common/bus/udpm_assembler.hpp"
#include "common/bus/udpm_url.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab {

/// The socket is bound to the group, so unicast datagrams never reach it, whoever sends them. With
/// ttl = 0 it takes datagrams of this machine only: those that came in on the loopback interface,
/// which nothing from outside does, and those whose source is an address of this machine. The
/// kernel drops such sources when they come from outside ("martian", __fib_validate_source() in
/// net/ipv4/fib_frontend.c), unless sysctl net.ipv4.conf.*.accept_local is set. With ttl > 0 it
/// takes what comes in on the interface by which the group is routed, whoever sends it.
///
/// A thread of its own reads the socket, as in liblcm, so that a busy program loses no messages.
class UdpmReceiver {
 public:
  /// Waiting messages beyond this are lost and counted; the fixed overhead of each
  /// message counts, too.
  static constexpr std::size_t kMostWaitingBytes = 64U << 20;

  /// @throws std::system_error
  explicit UdpmReceiver(const UdpmUrl& url);
  ~UdpmReceiver();
  UdpmReceiver(const UdpmReceiver&) = delete;
  UdpmReceiver& operator=(const UdpmReceiver&) = delete;

  /// Receives this channel from now on.
  void subscribe(std::string_view channel);
  void subscribeAll();

  /// Readable while messages are waiting, or if the socket has failed.
  [[nodiscard]] int fileDescriptor() const { return waiting_event_.get(); }

  /// @return the oldest waiting message
  std::optional<UdpmMessage> next();

  /// For how long the oldest waiting message has been waiting [us]; 0: none waits. By the steady
  /// clock, so that a step of the wall clock is no backlog.
  [[nodiscard]] std::int64_t backlog() const;

  /// @return errno of a socket that has failed, else 0
  [[nodiscard]] int error() const;

  /// Waits for LCM's probe (channels::kLcmSelfTest), which the caller sends.
  /// @return whether one has come since the construction
  bool waitForProbe(int timeout_ms);

  [[nodiscard]] RefusedDatagrams refused() const;

 private:
  class Batch;

  void read();
  void takeBatch(Batch& batch, int datagrams);
  bool accepts(std::uint32_t source, int interface_index);
  void countOverflow(std::uint32_t dropped_since_start, const DatagramSource& source);
  void keep(UdpmMessage message, const DatagramSource& source);
  void fail(int error);

  const bool is_open_;  ///< to other machines
  OwnAddresses own_addresses_;
  FileDescriptor socket_;
  FileDescriptor waiting_event_;
  FileDescriptor stop_event_;

  mutable std::mutex mutex_;  ///< for all members from here to error_
  std::condition_variable probed_;
  bool has_probe_ = false;
  bool wants_all_ = false;
  std::set<std::string, std::less<>> channels_;
  UdpmAssembler assembler_;
  struct Waiting {
    UdpmMessage message;
    std::chrono::steady_clock::time_point since;
  };
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint32_t dropped_ = 0;  ///< SO_RXQ_OVFL of the last datagram
  int error_ = 0;

  std::thread thread_;
};

}  // namespace lab
