#include "common/loop/virtual_loop.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace lab {

void VirtualLoop::at(std::int64_t utime, Callback callback) {
  schedule(utime, std::move(callback), 0);
}

void VirtualLoop::every(std::int64_t period_us, std::int64_t first_utime, Callback callback) {
  checkPeriod(period_us);
  schedule(first_utime, std::move(callback), period_us);
}

void VirtualLoop::schedule(std::int64_t utime, Callback callback, std::int64_t period_us) {
  std::size_t timer = timers_.size();
  if (free_.empty()) {
    timers_.emplace_back();
  } else {
    timer = free_.back();
    free_.pop_back();
  }
  timers_[timer] = {std::move(callback), period_us};
  events_.push({std::max(utime, now_), order_++, timer});
}

void VirtualLoop::runNext() {
  const Event event = events_.top();
  events_.pop();
  now_ = event.utime;
  // Moved out of the table while it runs, because a callback may schedule and so reallocate it.
  Callback callback = std::move(timers_[event.timer].callback);
  const std::int64_t period = timers_[event.timer].period_us;
  if (period > 0) events_.push({event.utime + period, order_++, event.timer});
  callback();
  if (period > 0) {
    timers_[event.timer].callback = std::move(callback);
  } else {
    free_.push_back(event.timer);
  }
  drain_();
}

void VirtualLoop::run() {
  stopped_ = false;
  drain_();
  while (!stopped_ && !events_.empty()) runNext();
}

void VirtualLoop::runUntil(std::int64_t utime) {
  stopped_ = false;
  drain_();
  while (!stopped_ && !events_.empty() && events_.top().utime <= utime) runNext();
  if (!stopped_) now_ = std::max(now_, utime);
}

}  // namespace lab
