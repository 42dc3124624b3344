/// The live bus: LCM over UDP multicast.
#pragma once

#include <lcm/lcm.h>

#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/bus_error.hpp"

namespace lab {

/// The URL of a bus on `port`. ttl = 0 keeps messages on this machine. recv_buf_size is needed by
/// every subscriber, lcm-logger included: with the default socket buffer, messages of several
/// datagrams are lost. Only different ports separate two buses, because LCM 1.3.1 binds to any
/// address and so receives from every multicast group.
std::string lcmUrl(int port, int ttl = 0);

/// The value of the environment variable LCM_DEFAULT_URL; if unset, lcmUrl() of LCM's default port
/// 7667.
std::string defaultLcmUrl();

/// Works around four limitations of LCM 1.3.1. The constructor detects a network without multicast,
/// which LCM does not report. Queues are unlimited instead of 31 messages long. Channel names are
/// matched literally instead of as regular expressions. Exceptions of handlers do not unwind
/// through LCM's C code: they are stored, and drain() throws them.
class LcmBus final : public Bus {
 public:
  /// @throws BusError with the command that repairs the network
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  void publish(std::string_view channel, Bytes data) override;
  void subscribe(std::string_view channel, PacketHandler handler) override;
  void subscribeAll(PacketHandler handler) override;

  /// Readable while messages are waiting.
  [[nodiscard]] int fileDescriptor() const;

  /// Handles all waiting messages, at most 10 000 and for at most about 0.1 s in one call, so that
  /// timers and signals are not starved.
  /// @throws the first exception that a handler threw; BusError if LCM has failed
  void drain();

  /// Waits at most `timeout_ms` for a message, then drains.
  /// @return whether a message was handled
  bool drainFor(int timeout_ms);

 private:
  struct Subscription;
  void add(const std::string& pattern, PacketHandler handler);

  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::unique_ptr<lcm_t, decltype(&lcm_destroy)> lcm_;
  std::exception_ptr error_;
  bool draining_ = false;
};

}  // namespace lab
