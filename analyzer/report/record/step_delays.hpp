/// Delays of the steps of the light script.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/report/record/run_record.hpp"
#include "common/math/percentiles.hpp"

namespace lab::report {

/// Delays from the command [ms]; nan: it did not happen.
struct StepDelays {
  double presented_ms = 0;
  double seen_ms = 0;
  double first_acted_ms = 0;
  double last_acted_ms = 0;
};

[[nodiscard]] StepDelays delaysOf(const StepRecord& step);

/// Percentiles of the delays that exist [ms].
[[nodiscard]] Percentiles presentedDelays(const std::vector<StepRecord>& steps);
[[nodiscard]] Percentiles seenDelays(const std::vector<StepRecord>& steps);
[[nodiscard]] Percentiles firstActedDelays(const std::vector<StepRecord>& steps);

/// Only of steps that all expected robots executed.
[[nodiscard]] Percentiles lastActedDelays(const std::vector<StepRecord>& steps);

/// "real", "simulated", "replayed", "unknown".
[[nodiscard]] std::string originName(std::int8_t origin);

}  // namespace lab::report
