/// Runs an adaptive campaign: round by round, on any engine that runs rows.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/local_engine.hpp"

namespace lab::runner::campaign {

using RunRows = std::function<EngineEnd(const std::vector<std::size_t>& rows)>;

/// Chooses runs, notes them in adaptive.jsonl, and runs them, until the plan's end. What was noted
/// and not run, because the campaign was killed, is run first, so that the choices after it are the
/// same. Says each round in a line on the terminal, and writes surface.csv.
/// @param first rows that are run before the first choice: failed or stale ones, on request
/// @throws UserError if the runs have no estimate of the plan's name
[[nodiscard]] EngineEnd runAdaptively(CampaignData& data, const std::filesystem::path& folder,
                                      const std::vector<std::size_t>& first,
                                      const RunRows& run_rows);

/// The rows that the campaign can afford: for its need of disk.
[[nodiscard]] std::vector<std::size_t> affordableRows(const CampaignData& data,
                                                      std::vector<std::size_t> rows);

}  // namespace lab::runner::campaign
