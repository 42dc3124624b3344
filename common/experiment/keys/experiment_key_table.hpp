/// The keys of an experiment file as people read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lab::keys {

/// Tables in Markdown, one for each table of the file: key, type, unit, default, allowed, meaning.
/// docs/experiments.md contains them word by word.
[[nodiscard]] std::string keyTables();

/// Paths of the keys called `name`, such as "camera.fps".
[[nodiscard]] std::vector<std::string> keyPathsEndingIn(std::string_view name);

/// The name among `names` that `name` was most likely meant to be, empty: none is near.
[[nodiscard]] std::string nearestKey(std::string_view name, const std::vector<std::string>& names);

}  // namespace lab::keys
