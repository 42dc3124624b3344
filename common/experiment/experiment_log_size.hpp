/// How large a run's log becomes.
#pragma once

#include "common/experiment/experiment.hpp"

namespace lab {

/// Bytes of the log, from the sizes and rates of the messages that a run of this experiment sends.
/// The analyzer's share is a guess from above: every robot runs every program, with full curves.
[[nodiscard]] double expectedLogBytes(const Experiment& experiment);

}  // namespace lab
