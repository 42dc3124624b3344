/// Files that are complete or not there.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lab::runner::campaign {

/// A file could not be written for want of space; nothing was replaced.
class DiskFull : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Sync : bool { kNo, kYes };

/// Writes beside the file, then renames. A reader finds the former or the new content.
/// @param sync kYes: on the disk before it is renamed, for files that cannot be computed again
/// @throws DiskFull, std::runtime_error
void replaceFile(const std::filesystem::path& file, std::string_view text, Sync sync = Sync::kNo);

/// Removes what killed processes of this host left beside the files of a folder. Does nothing if
/// there is no such folder.
void removeAbandonedFiles(const std::filesystem::path& folder);

/// Whether a text names an error of a full disk.
[[nodiscard]] bool tellsOfFullDisk(std::string_view text);

}  // namespace lab::runner::campaign
