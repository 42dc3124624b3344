/// Folders at a known name in /tmp, where another user may have made one of that name first.
#pragma once

#include <filesystem>

namespace lab {

/// Whether a folder is at this path that belongs to this user. A link to one is none.
[[nodiscard]] bool isOwnFolder(const std::filesystem::path& folder);

}  // namespace lab
