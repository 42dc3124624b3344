/// Virtual time: the clock jumps to the next event.
#pragma once

#include <cstdint>
#include <queue>
#include <vector>

#include "common/loop/loop.hpp"

namespace lab {

/// Runs events in order of time, and simultaneous ones in the order in which they were scheduled.
/// After each event, and before time moves on, a callback delivers all messages of the bus. Two
/// runs are therefore equal to the bit.
class VirtualLoop final : public Loop {
 public:
  /// Virtual time starts at a fixed epoch, 2000-01-01 00:00:00 UTC, so that logs do not depend on
  /// when they were made.
  static constexpr std::int64_t kEpoch = 946'684'800'000'000;

  explicit VirtualLoop(std::int64_t start = kEpoch) : now_(start) {}

  /// Sets the callback that is called after every event.
  void drainWith(Callback drain) { drain_ = std::move(drain); }

  [[nodiscard]] std::int64_t now() const override { return now_; }
  [[nodiscard]] bool isVirtual() const override { return true; }
  void at(std::int64_t utime, Callback callback) override;
  void every(std::int64_t period_us, std::int64_t first_utime, Callback callback) override;
  void stop() override { stopped_ = true; }

  /// Runs until stop(), or until nothing is scheduled.
  void run();

  /// Runs every event up to and including `utime`. The clock is then at `utime`, or at the event
  /// that called stop().
  void runUntil(std::int64_t utime);

 private:
  struct Event {
    std::int64_t utime;
    std::uint64_t order;
    std::size_t timer;  ///< index into timers_
    bool operator>(const Event& other) const {
      return utime != other.utime ? utime > other.utime : order > other.order;
    }
  };
  struct Timer {
    Callback callback;
    std::int64_t period_us = 0;  ///< 0: once
  };

  void schedule(std::int64_t utime, Callback callback, std::int64_t period_us);
  void runNext();

  std::int64_t now_;
  std::uint64_t order_ = 0;
  bool stopped_ = false;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::vector<Timer> timers_;
  std::vector<std::size_t> free_;
  Callback drain_ = [] {};
};

}  // namespace lab
