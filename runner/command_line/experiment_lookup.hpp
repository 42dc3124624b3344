#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lab::runner {

/// The names of a folder's TOML files, without ".toml", sorted. Empty if there is no such folder.
[[nodiscard]] std::vector<std::string> tomlNamesIn(const std::filesystem::path& folder);

/// Finds the experiment file that a user named. A path with a folder, and the name of an existing
/// file, are returned unchanged. Any other name is that of a shipped experiment, with or without
/// ".toml".
/// @param shipped folder of shipped experiments; may not exist
/// @throws UserError that names the places searched and the shipped experiments
[[nodiscard]] std::filesystem::path findExperiment(const std::filesystem::path& named,
                                                   const std::filesystem::path& shipped);

}  // namespace lab::runner
