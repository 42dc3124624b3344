/// Which points of a campaign are known well enough. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/live/live_plan.hpp"

namespace lab::runner::campaign {

/// The points with at least two runs whose means have the relative standard errors of all rules. A
/// rule without a program's name counts for all programs.
/// @throws UserError if the runs give no such quantity
[[nodiscard]] std::vector<std::size_t> knownPoints(const PooledTable& pooled,
                                                   const std::vector<KnownRule>& rules);

}  // namespace lab::runner::campaign
