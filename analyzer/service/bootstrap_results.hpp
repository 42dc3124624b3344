#pragma once

#include <vector>

#include "analyzer/service/program_analysis.hpp"

namespace lab::analysis {

/// Adds the results of one program that need simulated recordings: the fit of the exact law, its
/// tests, and the errors of lags beyond a 180th of a recording. The recordings are simulated once,
/// for the pool; the robots use them scaled to their time.
/// @param pool_data blocks of the pool; robot_data: blocks of `robots`, in their order
void addBootstrapResults(ProgramResult& pool, const BlockData& pool_data,
                         std::vector<ProgramResult>& robots,
                         const std::vector<const BlockData*>& robot_data,
                         const CurveOptions& options);

}  // namespace lab::analysis
