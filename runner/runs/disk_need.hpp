#pragma once

#include <cstdint>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// Bytes that a run of this experiment will leave behind, generously: log, trajectories, figures,
/// and a reserve that stays free.
[[nodiscard]] std::int64_t diskNeed_bytes(const Experiment& experiment);

}  // namespace lab::runner
