/// Collective results as COLLECTIVE messages.
#pragma once

#include <cstddef>
#include <lab/collective_t.hpp>
#include <vector>

#include "analyzer/service/collective_feed.hpp"

namespace lab::analysis {

/// A COLLECTIVE message about up to 1000 robots is smaller than this [bytes].
inline constexpr std::size_t kLargestCollective = 24'576;

/// The results so far: of all robots, then per program. The first one has the robots of the last
/// frame. Headers are left empty, but for utime. Names of programs are those of the messages.
[[nodiscard]] std::vector<collective_t> collectiveMessages(const CollectiveFeed& feed);

}  // namespace lab::analysis
