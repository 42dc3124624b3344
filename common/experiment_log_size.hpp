/// How large a run's log becomes.
#pragma once

#include "common/experiment.hpp"

namespace lab {

/// Bytes of the log, from the sizes and rates of the messages that a run of this experiment sends;
/// right within some ten percent. The analyzer's curves are taken at their usual length.
[[nodiscard]] double expectedLogBytes(const Experiment& experiment);

}  // namespace lab
