/// The live bus: LCM over UDP multicast.
#pragma once

#include <lcm/lcm.h>

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/bus_error.hpp"
#include "common/bus/refused_datagrams.hpp"

namespace lab {

class UdpmReceiver;
struct UdpmUrl;

/// The URL of a bus on `port`. ttl = 0 keeps messages on this machine, and LcmBus then takes
/// messages of this machine only. recv_buf_size is needed by every subscriber, lcm-logger included:
/// with the default socket buffer, messages of several datagrams are lost. Only different ports
/// separate two buses, because programs with LCM 1.3.1 (lcm-logger) bind to any address and so
/// receive from every multicast group.
std::string lcmUrl(int port, int ttl = 0);

/// The value of the environment variable LCM_DEFAULT_URL; if unset, lcmUrl() of LCM's default port
/// 7667.
std::string defaultLcmUrl();

/// Sends with liblcm, and receives UDP multicast (udpm://) with UdpmReceiver, because liblcm takes
/// datagrams of every sender and can be made to write out of bounds. memq:// (within a
/// process) is received with liblcm, too; all other providers are refused.
///
/// The constructor detects a network without multicast, which LCM does not report. A queue holds
/// 64 MB instead of LCM's 31 messages. Channel names are matched literally, not as regular
/// expressions as LCM does. All handlers get a message even if one throws: the first exception is
/// stored, and drain() throws it.
class LcmBus final : public Bus {
 public:
  /// @param url empty: defaultLcmUrl()
  /// @throws BusError with the command that repairs the network, or the provider that is refused
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  void publish(std::string_view channel, Bytes data) override;
  void subscribe(std::string_view channel, PacketHandler handler) override;
  void subscribeAll(PacketHandler handler) override;
  /// 0 with memq://.
  [[nodiscard]] std::int64_t backlog() const override;

  /// Readable while messages are waiting.
  [[nodiscard]] int fileDescriptor() const;

  /// What was received and refused, or lost; nothing with memq://.
  [[nodiscard]] RefusedDatagrams refused() const;

  /// Handles all waiting messages, at most 10 000 and for at most about 0.1 s in one call, so that
  /// timers and signals are not starved.
  /// @throws the first exception that a handler threw; BusError if LCM has failed
  void drain();

  /// Waits at most `timeout_ms` for a message, then drains.
  /// @return whether a message was handled
  bool drainFor(int timeout_ms);

 private:
  struct Subscription;

  void receiveFrom(const UdpmUrl& udpm);
  void add(std::optional<std::string> channel, const std::string& pattern, PacketHandler handler);
  int handleReceived(int timeout_ms);
  [[nodiscard]] std::string noMulticast() const;

  std::string url_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::unique_ptr<lcm_t, decltype(&lcm_destroy)> lcm_;
  std::unique_ptr<UdpmReceiver> receiver_;  ///< nothing: LCM receives
  std::exception_ptr error_;
  bool draining_ = false;
};

}  // namespace lab
