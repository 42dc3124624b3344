/// Files that appear under their names only when they are complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lab {

/// A file could not be written for want of space; nothing was replaced.
class DiskFull : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Sync : bool { kNo, kYes };

/// Writes beside the file, then renames. A reader finds the former or the new content. A link of
/// this name is replaced, not followed. Several processes and hosts may replace the same file.
/// @param sync kYes: on the disk before it is renamed, for files that cannot be computed again
/// @throws DiskFull
/// @throws std::runtime_error also if a folder, a device or a pipe has this name
void replaceFile(const std::filesystem::path& file, std::string_view text, Sync sync = Sync::kNo);
void replaceFile(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// Removes what killed processes of this host left beside the files of a folder. Does nothing if
/// there is no such folder.
void removeAbandonedFiles(const std::filesystem::path& folder);

/// Whether a text names an error of a full disk.
[[nodiscard]] bool tellsOfFullDisk(std::string_view text);

/// A file that is written piece by piece or by another program.
class AtomicFile {
 public:
  /// Its part is NAME.part. A link of this name is removed, not followed.
  explicit AtomicFile(std::filesystem::path path);
  /// For programs that choose the format by the ending of the name.
  AtomicFile(std::filesystem::path path, std::filesystem::path part);
  /// Removes the part if the file was not finished.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  /// Gives the part its name. @throws std::filesystem::filesystem_error
  void finish();

 private:
  std::filesystem::path path_;
  std::filesystem::path part_;
};

}  // namespace lab
