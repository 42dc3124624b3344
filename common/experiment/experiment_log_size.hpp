/// The expected size of a run's log.
#pragma once

#include "common/experiment/experiment.hpp"

namespace lab {

/// The size of the log [bytes], from the sizes and rates of the messages of such a run. The
/// analyzer's part is an upper bound: every robot runs every program, and all curves are complete.
[[nodiscard]] double expectedLogBytes(const Experiment& experiment);

}  // namespace lab
