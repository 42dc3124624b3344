#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lab::runner {

/// The names of a folder's TOML files, without ".toml", sorted. None if there is no such folder.
[[nodiscard]] std::vector<std::string> tomlNamesIn(const std::filesystem::path& folder);

/// Finds the experiment file that a user named: a file, or else, if no folder was named, the
/// shipped experiment of that name, with or without ".toml".
/// @param shipped folder of shipped experiments; may not exist
/// @throws UserError that names the places searched and the shipped experiments
[[nodiscard]] std::filesystem::path findExperiment(const std::filesystem::path& named,
                                                   const std::filesystem::path& shipped);

}  // namespace lab::runner
