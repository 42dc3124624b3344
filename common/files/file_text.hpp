/// Reading a whole file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lab {

/// The content of a file, none if it cannot be opened or read.
[[nodiscard]] std::optional<std::string> readWholeFile(const std::filesystem::path& file);

/// The content of a file.
/// @throws ExperimentError that names the file when it is a folder or cannot be read
[[nodiscard]] std::string readFileText(const std::string& name);

}  // namespace lab
