/// The IPv4 addresses of this machine.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

namespace lab {

/// IPv4 addresses of all interfaces of this network namespace, in host byte order. Empty if they
/// cannot be read, for example because no descriptor is free.
[[nodiscard]] std::vector<std::uint32_t> interfaceAddresses();

/// Remembers the addresses and reads them again when it is asked for an unknown one, at most once a
/// second, because an address may be added while a lab runs.
class OwnAddresses {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;
  using Read = std::function<std::vector<std::uint32_t>()>;

  explicit OwnAddresses(Read read = interfaceAddresses,
                        Clock clock = &std::chrono::steady_clock::now);

  /// @param address in host byte order
  [[nodiscard]] bool contains(std::uint32_t address);

 private:
  void read();

  Read read_;
  Clock clock_;
  std::vector<std::uint32_t> addresses_;  ///< sorted
  std::chrono::steady_clock::time_point read_at_;
};

}  // namespace lab
