/// The changes of the hub as server-sent events, for one client.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dashboard/web/hub.hpp"

namespace lab::dashboard {

/// Returns the text to write next. After 10 s without a change this is a comment, so that the
/// server notices a client that has gone, and the client knows that the server is alive.
class EventStream {
 public:
  explicit EventStream(const Hub& hub) : hub_(hub) {}

  /// Waits for a change, at most 0.25 s. @return empty if nothing is to be written
  [[nodiscard]] std::string next();

 private:
  using Clock = std::chrono::steady_clock;

  const Hub& hub_;
  std::uint64_t seen_ = 0;
  bool begun_ = false;
  Clock::time_point written_ = Clock::now();
};

/// Appends one event. A text of several lines remains one event.
void appendEvent(std::string& to, std::string_view topic, std::string_view text);

}  // namespace lab::dashboard
