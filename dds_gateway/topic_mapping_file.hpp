/// Topic mappings as files.
#pragma once

#include <filesystem>
#include <string>

namespace lab::gateway {

/// The text of a file that is a topic mapping (docs/ros2.md).
/// @throws ExperimentError if it cannot be read or is something else
[[nodiscard]] std::string topicMappingText(const std::filesystem::path& file);

}  // namespace lab::gateway
