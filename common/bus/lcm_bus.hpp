/// The live bus: LCM over UDP multicast.
#pragma once

#include <lcm/lcm.h>

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/bus_error.hpp"

namespace lab {

/// The URL of a lab on `port`. ttl 0 keeps it on this machine; recv_buf_size is for every listener,
/// lcm-logger too: the default socket buffer loses messages of more than one datagram. Only the
/// port separates two labs: LCM 1.3.1 binds to any address, so the group does not.
std::string lcmUrl(int port, int ttl = 0);

/// What the environment's LCM_DEFAULT_URL says, otherwise the lab's URL on LCM's usual port, 7667.
std::string defaultLcmUrl();

/// Meets the traps of LCM 1.3.1 in one place: the constructor finds a network that cannot carry
/// multicast (LCM itself never says so), queues are unlimited instead of 31 messages, channel names
/// are matched literally instead of as regular expressions, and no exception ever unwinds through
/// LCM's C code: it is kept and thrown by drain().
class LcmBus final : public Bus {
 public:
  /// @throws BusError with the line that repairs the network.
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  void publish(std::string_view channel, Bytes data) override;
  void subscribe(std::string_view channel, PacketHandler handler) override;
  void subscribeAll(PacketHandler handler) override;

  /// Readable while messages wait.
  [[nodiscard]] int fileDescriptor() const;

  /// Handles every waiting message, or 10 000 of a flood, so that timers and signals get their
  /// turn.
  /// @throws whatever a handler threw, the first of them; BusError when LCM has failed.
  void drain();

  /// Waits for a message at most this long, then drains. @return whether there was one.
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
