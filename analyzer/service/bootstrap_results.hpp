#pragma once

#include <vector>

#include "analyzer/service/program_analysis.hpp"

namespace lab::analysis {

/// Adds to the results of one program what needs simulated recordings: the fit of the exact law,
/// its tests, and errors of lags beyond a 180th of a recording. The recordings are simulated once,
/// for the pool; its robots reuse them, scaled to their time.
/// @param pool_data of the pool, robot_data of `robots` in their order.
void addBootstrapResults(ProgramResult& pool, const BlockData& pool_data,
                         std::vector<ProgramResult>& robots,
                         const std::vector<const BlockData*>& robot_data,
                         const CurveOptions& options);

}  // namespace lab::analysis
