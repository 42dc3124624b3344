/// The collective numbers that conditions and layers may name (docs/collective.md).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace lab {

/// Those that have a value in every frame.
inline constexpr std::array<std::string_view, 11> kFrameObservables{"polar_order",
                                                                    "nematic_order",
                                                                    "hexatic_order",
                                                                    "hexatic_order_global",
                                                                    "largest_cluster",
                                                                    "mean_cluster",
                                                                    "clusters",
                                                                    "clustered_share",
                                                                    "local_density",
                                                                    "speed",
                                                                    "local_density_scatter"};

/// Those that only have an average over the run.
inline constexpr std::array<std::string_view, 6> kAverageObservables{
    "touching_share", "wall_share", "contact_time",
    "wall_time",      "bimodality", "number_fluctuation_exponent"};

/// The most robots of a frame that the analyzer counts for collective numbers. Those of more are
/// not of all robots.
inline constexpr std::size_t kMostCrowdRobots = 1000;

/// Before the name of a region: the share of the robots in it.
inline constexpr std::string_view kShareIn = "share_in_";

[[nodiscard]] inline bool hasValueInFrames(std::string_view name) {
  return name.starts_with(kShareIn) ||
         std::ranges::find(kFrameObservables, name) != kFrameObservables.end();
}

}  // namespace lab
