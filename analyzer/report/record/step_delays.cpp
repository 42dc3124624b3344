#include "analyzer/report/record/step_delays.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "common/math/units.hpp"

namespace lab::report {
namespace {

using units::kNan;

double delay(std::int64_t from, std::int64_t to) {
  return from == 0 || to == 0 ? kNan : static_cast<double>(to - from) * 1e-3;
}

template <class Value>
Percentiles collect(const std::vector<StepRecord>& steps, Value value) {
  std::vector<double> values;
  for (const StepRecord& step : steps) {
    const double delay = value(step);
    if (std::isfinite(delay)) values.push_back(delay);
  }
  return percentilesOf(std::move(values));
}

}  // namespace

StepDelays delaysOf(const StepRecord& step) {
  return {delay(step.commanded_utime, step.presented_utime),
          delay(step.commanded_utime, step.seen_utime),
          delay(step.commanded_utime, step.first_acted_utime),
          delay(step.commanded_utime, step.last_acted_utime)};
}

Percentiles presentedDelays(const std::vector<StepRecord>& steps) {
  return collect(steps, [](const StepRecord& step) { return delaysOf(step).presented_ms; });
}

Percentiles seenDelays(const std::vector<StepRecord>& steps) {
  return collect(steps, [](const StepRecord& step) { return delaysOf(step).seen_ms; });
}

Percentiles firstActedDelays(const std::vector<StepRecord>& steps) {
  return collect(steps, [](const StepRecord& step) { return delaysOf(step).first_acted_ms; });
}

Percentiles lastActedDelays(const std::vector<StepRecord>& steps) {
  return collect(steps, [](const StepRecord& step) {
    const bool all = step.robots_expected > 0 && step.robots_acted >= step.robots_expected;
    return all ? delaysOf(step).last_acted_ms : kNan;
  });
}

std::string originName(std::int8_t origin) {
  switch (origin) {
    case robot_state_t::REAL:
      return "real";
    case robot_state_t::SIM:
      return "simulated";
    case robot_state_t::REPLAY:
      return "replayed";
    default:
      return "unknown";
  }
}

}  // namespace lab::report
