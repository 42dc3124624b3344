#include "runner/script/delivery_times.hpp"

#include <cstdint>

#include "common/math/percentiles.hpp"
#include "common/math/units.hpp"

namespace lab::runner {

void DeliveryTimes::add(const experiment_event_t& step) {
  ++steps_;
  const auto record = [&step](std::vector<double>& delays, std::int64_t utime) {
    if (utime != 0) delays.push_back(units::seconds(utime - step.commanded_utime));
  };
  record(presented_, step.presented_utime);
  record(seen_, step.seen_utime);
  record(first_acted_, step.first_acted_utime);
  // The last one is known only if all robots acted.
  if (step.robots_acted >= step.robots_expected) record(last_acted_, step.last_acted_utime);
}

light_delivery_t DeliveryTimes::message() const {
  light_delivery_t message{};
  message.steps = steps_;
  const auto add = [&message](const char* until, const std::vector<double>& delays) {
    if (delays.empty()) return;
    const Percentiles all = percentilesOf(delays);
    light_delay_t delay{};
    delay.until = until;
    delay.count = static_cast<std::int32_t>(all.count);
    delay.p50 = all.p50;
    delay.p95 = all.p95;
    delay.p99 = all.p99;
    delay.max = all.max;
    message.delays.push_back(delay);
  };
  add("presented", presented_);
  add("seen", seen_);
  add("first acted", first_acted_);
  add("last acted", last_acted_);
  message.num_delays = static_cast<std::int32_t>(message.delays.size());
  return message;
}

}  // namespace lab::runner
