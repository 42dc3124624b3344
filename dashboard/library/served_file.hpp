/// Which files of a folder the web server sends.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace lab::dashboard {

/// Whether a part of a path is a plain name: not empty, not hidden, without separators.
[[nodiscard]] bool isPlainName(std::string_view name);

/// The path of a file of a report: "msd_NAME.svg" or "figures/msd_NAME.csv". Nothing if it does not
/// exist, is of another type, or is a link to a file outside the folder.
[[nodiscard]] std::optional<std::filesystem::path> servedFile(const std::filesystem::path& folder,
                                                              std::string_view name);

}  // namespace lab::dashboard
