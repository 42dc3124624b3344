/// What `lab sweep` says of a campaign before anything runs.
#pragma once

#include <cstddef>
#include <filesystem>

#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// What is there.
void describe(const CampaignData& data, const std::filesystem::path& folder);

/// Lists rows of a kind: the first ones, then their number.
void listRows(const CampaignData& data, RowState::Kind kind, const char* word);

/// Says which results are damaged, stale or failed, and what happens to them.
/// @param retry failed runs are tried again
/// @param redo_stale results of another version are computed again
void describeProblems(const CampaignData& data, const std::filesystem::path& folder, bool retry,
                      bool redo_stale);

}  // namespace lab::runner::campaign
