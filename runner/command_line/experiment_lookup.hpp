#pragma once

#include <filesystem>

namespace lab::runner {

/// The experiment file that a user named: a file; or, where there is none and no folder was named,
/// the shipped experiment of that name, with or without ".toml".
/// @param shipped folder of shipped experiments; may not exist
/// @throws UserError that says where was looked and which experiments are shipped
[[nodiscard]] std::filesystem::path findExperiment(const std::filesystem::path& named,
                                                   const std::filesystem::path& shipped);

}  // namespace lab::runner
