/// Packets of other hosts that wait until the clock of their host is known.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lab::gateway {

struct HeldPacket {
  std::int64_t gateway = 0;
  std::int32_t stream = 0;
  std::int64_t number = 0;
  std::int64_t heard = 0;
  std::string channel;
  std::vector<std::uint8_t> data;

  /// Memory of this packet [byte]: also one without data takes some.
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(HeldPacket) + channel.size() + data.size();
  }
};

/// Bounded in the number of hosts, the packets of a host, and the bytes of all together. The
/// dropped packets are the oldest of the host that holds most, so a flood costs its own host first.
class HeldPackets {
 public:
  static constexpr std::size_t kMostPackets = 2000;      ///< of a host
  static constexpr std::size_t kMostBytes = 16'000'000;  ///< of all hosts

  /// @param most_hosts packets of further hosts are dropped
  /// @param most_bytes of all hosts
  explicit HeldPackets(std::size_t most_hosts, std::size_t most_bytes = kMostBytes)
      : most_hosts_(most_hosts), most_bytes_(most_bytes) {}

  void add(const std::string& host, HeldPacket packet) {
    if (packet.bytes() > most_bytes_) return;
    if (hosts_.size() >= most_hosts_ && !hosts_.contains(host)) return;
    Waiting& waiting = hosts_[host];
    waiting.bytes += packet.bytes();
    bytes_ += packet.bytes();
    waiting.packets.push_back(std::move(packet));
    if (waiting.packets.size() > kMostPackets) dropOldest(waiting);
    while (bytes_ > most_bytes_) {
      dropOldest(std::ranges::max_element(hosts_, {}, [](const auto& entry) {
                   return entry.second.bytes;
                 })->second);
    }
  }

  /// Removes the packets of a host. @return them, the oldest first
  [[nodiscard]] std::deque<HeldPacket> take(const std::string& host) {
    const auto found = hosts_.find(host);
    if (found == hosts_.end()) return {};
    bytes_ -= found->second.bytes;
    std::deque<HeldPacket> packets = std::move(found->second.packets);
    hosts_.erase(found);
    return packets;
  }

  /// Memory of all packets [byte].
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Waiting {
    std::deque<HeldPacket> packets;
    std::size_t bytes = 0;
  };

  void dropOldest(Waiting& waiting) {
    const std::size_t bytes = waiting.packets.front().bytes();
    waiting.bytes -= bytes;
    bytes_ -= bytes;
    waiting.packets.pop_front();
  }

  std::size_t most_hosts_;
  std::size_t most_bytes_;
  std::map<std::string, Waiting> hosts_;
  std::size_t bytes_ = 0;
};

}  // namespace lab::gateway
