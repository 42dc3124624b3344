#include "common/bus/memory_bus.hpp"

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace lab {

void MemoryBus::publish(std::string_view channel, Bytes data) {
  checkChannelName(channel);
  queue_.push_back({std::string(channel), {data.begin(), data.end()}, clock_()});
}

void MemoryBus::subscribe(std::string_view channel, PacketHandler handler) {
  add(channel, std::move(handler));
}

void MemoryBus::subscribeAll(PacketHandler handler) { add({}, std::move(handler)); }

std::int64_t MemoryBus::backlog() const {
  return queue_.empty() ? 0 : clock_() - queue_.front().utime;
}

void MemoryBus::add(std::string_view channel, PacketHandler handler) {
  if (delivering_) throw std::logic_error("subscribe at start, not inside a handler");
  const std::uint64_t number = listeners_.size();
  listeners_.push_back({std::string(channel), std::move(handler), Random(loss_seed_, number)});
}

void MemoryBus::deliver() {
  if (delivering_) return;
  delivering_ = true;
  while (!queue_.empty()) {
    const Message message = std::move(queue_.front());
    queue_.pop_front();
    deliver(message);
  }
  delivering_ = false;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void MemoryBus::deliver(const Message& message) {
  static std::atomic<std::uint64_t> messages = 0;
  const Packet packet{message.channel, message.data, clock_(), ++messages};
  for (Listener& listener : listeners_) {
    if (!listener.channel.empty() && listener.channel != message.channel) continue;
    if (loss_ > 0 && listener.random.uniform() < loss_) continue;
    try {
      listener.handler(packet);
    } catch (...) {
      if (!error_) error_ = std::current_exception();
    }
  }
}

void MemoryBus::loseAtRandom(double probability, std::uint64_t seed) {
  loss_ = probability;
  loss_seed_ = seed;
  for (std::size_t i = 0; i < listeners_.size(); ++i) listeners_[i].random = Random(seed, i);
}

}  // namespace lab
