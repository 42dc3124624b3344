/// Folders for unfinished files.
#pragma once

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace lab {

/// Makes a new folder PARENT/NAME-XXXXXX, readable by its owner only, and PARENT if it is missing.
/// @returns its path; empty: it cannot be made (errno says why)
[[nodiscard]] std::filesystem::path makeUniqueFolder(const std::filesystem::path& parent,
                                                     std::string_view name);

/// Owns a folder, which is removed with its content at the end, unless it was moved away.
class ScratchFolder {
 public:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lab
