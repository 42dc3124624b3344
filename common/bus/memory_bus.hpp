/// A bus inside one process, for virtual time and for tests.
#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/bus_error.hpp"
#include "common/math/random.hpp"

namespace lab {

/// publish() queues messages and deliver() delivers them in order, so a handler that publishes does
/// not recurse. Every subscriber receives every message, including its own. With a loss rate, each
/// delivery to each subscriber is dropped at random and independently, as on a network.
class MemoryBus final : public Bus {
 public:
  using Clock = std::function<std::int64_t()>;

  /// @param clock returns the time of arrival [us since 1970]
  explicit MemoryBus(Clock clock) : clock_(std::move(clock)) {}

  void publish(std::string_view channel, Bytes data) override;
  void subscribe(std::string_view channel, PacketHandler handler) override;
  void subscribeAll(PacketHandler handler) override;
  [[nodiscard]] std::int64_t backlog() const override;

  /// Delivers all queued messages, including those that handlers publish meanwhile. If a handler
  /// throws, the others still get the message.
  /// @throws the first exception that a handler threw, after everything is delivered
  void deliver();

  /// From now on, drops each delivery with this probability.
  void loseAtRandom(double probability, std::uint64_t seed);

 private:
  struct Listener {
    std::string channel;  ///< empty: every channel
    PacketHandler handler;
    Random random{0};
  };
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> data;
    std::int64_t utime = 0;  ///< of publish()
  };

  void add(std::string_view channel, PacketHandler handler);
  void deliver(const Message& message);

  Clock clock_;
  std::vector<Listener> listeners_;
  std::deque<Message> queue_;
  bool delivering_ = false;
  std::exception_ptr error_;
  double loss_ = 0;
  std::uint64_t loss_seed_ = 0;
};

}  // namespace lab
