/// From a command line to the campaign it means.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/sweep_command.hpp"

namespace lab::runner::campaign {

/// The request of a command line with the table [sweep] of the experiment file.
/// @param text of the file. @throws UserError, ExperimentError
[[nodiscard]] Request requestOf(const SweepOptions& options, const std::string& text);

/// Whether both ask for the same: the file may have changed, and how a live campaign is played, and
/// when an adaptive one ends.
[[nodiscard]] bool isSameRequest(const Request& one, const Request& other);

/// The newest campaign in `folder` that asks for the same.
[[nodiscard]] std::optional<std::filesystem::path> findCampaign(const std::filesystem::path& folder,
                                                                const Request& request);

}  // namespace lab::runner::campaign
