/// Links where the lab writes, or what it passes on. The folder of a run or of a campaign may come
/// from a stranger: a link in it must not lead the lab to another place.
#pragma once

#include <filesystem>
#include <string>

namespace lab {

/// Whether a symbolic link is at this path.
[[nodiscard]] bool isLink(const std::filesystem::path& path);

/// Whether a path leads out of a folder, by links in it; also if it cannot be followed.
[[nodiscard]] bool leadsOutOf(const std::filesystem::path& folder,
                              const std::filesystem::path& path);

/// What to say if a symbolic link stands where the lab writes a folder or file of its own; empty if
/// none does.
[[nodiscard]] std::string explainLink(const std::filesystem::path& path);

/// Removes a symbolic link at the name of a file that is to be written, so that the file replaces
/// it.
void removeLink(const std::filesystem::path& file);

}  // namespace lab
