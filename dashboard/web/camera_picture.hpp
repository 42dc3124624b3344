/// The tracker's picture, fetched once for all who look.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>

namespace lab::dashboard {

/// A still of the tracker's debug view on this machine, at most ten a second however many ask, and
/// within a second or not at all. From any thread.
class CameraPicture {
 public:
  using Text = std::shared_ptr<const std::string>;

  /// @param port of the debug view
  explicit CameraPicture(int port) : port_(port) {}

  /// JPEG, a tenth of a second old at most; null: none came.
  [[nodiscard]] Text newest();

 private:
  using Clock = std::chrono::steady_clock;

  int port_;
  std::mutex mutex_;
  Text picture_;
  Clock::time_point fetched_{};
};

}  // namespace lab::dashboard
