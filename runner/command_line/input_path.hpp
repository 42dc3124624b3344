#pragma once

#include <filesystem>

#include "common/files/file_text.hpp"

namespace lab::runner {

/// Refuses an argument that is neither a folder nor a regular file. What a folder must contain is
/// checked where it is read.
/// @param expected what it should be, and its largest size
/// @throws UserError with what it is
void requireFolderOrFile(const std::filesystem::path& input, const FileKind& expected);

}  // namespace lab::runner
