/// When each step of a light script is due.
#pragma once

#include <cstddef>
#include <optional>

#include "common/experiment.hpp"

namespace lab::runner {

/// One showing of one step.
struct ScheduledStep {
  int number = 0;         ///< counts from 0 over the whole run
  std::size_t index = 0;  ///< into LightScript::steps
  double at = 0;          ///< [s] since the run began

  bool operator==(const ScheduledStep&) const = default;
};

/// The `number`-th showing, counting from 0 through all repetitions, or nothing when the script is
/// over or the run is.
[[nodiscard]] std::optional<ScheduledStep> scheduledStep(const LightScript& script, double duration,
                                                         int number);

}  // namespace lab::runner
