/// The tracker's newest picture, fetched once for all viewers.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

namespace lab::dashboard {

/// Fetches stills from the tracker's debug view on this host, at most ten per second for any number
/// of callers. Thread-safe.
class CameraPicture {
 public:
  using Text = std::shared_ptr<const std::string>;

  /// @param port of the debug view on 127.0.0.1
  explicit CameraPicture(int port) : port_(port) {}

  /// A JPEG that was fetched at most 0.1 s ago; null if none arrives within a second.
  [[nodiscard]] Text newest();

 private:
  using Clock = std::chrono::steady_clock;

  int port_;
  std::mutex mutex_;
  Text picture_;
  Clock::time_point fetched_{};
};

}  // namespace lab::dashboard
