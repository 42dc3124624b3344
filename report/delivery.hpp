/// How long the light script's steps took to arrive.
#pragma once

#include <string>
#include <vector>

#include "report/run_record.hpp"

namespace lab::report {

/// From the command [ms]; nan: it never came to that.
struct StepDelays {
  double presented_ms = 0;
  double first_acted_ms = 0;
  double last_acted_ms = 0;
};

[[nodiscard]] StepDelays delaysOf(const StepRecord& step);

/// Of the delays that exist [ms]; nan without any. By nearest rank, so each is a delay that
/// happened.
struct Percentiles {
  std::size_t count = 0;
  double p50 = 0;
  double p99 = 0;
  double max = 0;
};

[[nodiscard]] Percentiles percentilesOf(std::vector<double> values);
[[nodiscard]] Percentiles presentedDelays(const std::vector<StepRecord>& steps);
[[nodiscard]] Percentiles firstActedDelays(const std::vector<StepRecord>& steps);

/// Only of steps that every robot that had to change has obeyed.
[[nodiscard]] Percentiles lastActedDelays(const std::vector<StepRecord>& steps);

/// "real", "simulated", "replayed", "unknown".
[[nodiscard]] std::string originName(std::int8_t origin);

}  // namespace lab::report
