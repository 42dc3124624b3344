/// The hub's changes as server-sent events, for one client.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "dashboard/web/hub.hpp"

namespace lab::dashboard {

/// What is to be written next; a comment where nothing changed for long, so that a client that has
/// gone is noticed and one that listens knows that the server lives.
class EventStream {
 public:
  explicit EventStream(const Hub& hub) : hub_(hub) {}

  /// Waits for it, a quarter of a second at most; empty: nothing is due.
  [[nodiscard]] std::string next();

 private:
  using Clock = std::chrono::steady_clock;

  const Hub& hub_;
  std::uint64_t seen_ = 0;
  bool begun_ = false;
  Clock::time_point written_ = Clock::now();
};

/// One event; a text of several lines stays one.
void appendEvent(std::string& to, std::string_view topic, std::string_view text);

}  // namespace lab::dashboard
