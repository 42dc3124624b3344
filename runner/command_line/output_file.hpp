#pragma once

#include <filesystem>

namespace lab::runner {

/// Checks that a file can be written, before the work for it begins.
/// @param force allows replacing a file that exists
/// @throws UserError when it exists and may not be replaced, when it is a folder or a
///   device, or when its folder does not exist or is not writable
void checkOutput(const std::filesystem::path& path, bool force);

/// @throws UserError if a symbolic link stands where the lab writes (output_links.hpp)
void refuseLink(const std::filesystem::path& path);

}  // namespace lab::runner
