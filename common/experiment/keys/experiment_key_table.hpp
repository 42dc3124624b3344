/// Documentation of the keys of an experiment file, and search for similar keys.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lab::keys {

/// Markdown tables, one for each table of the file: key, type, unit, default, allowed, meaning.
/// docs/experiments.md contains them literally.
[[nodiscard]] std::string keyTables();

/// Paths of the keys called `name`, such as "camera.fps".
[[nodiscard]] std::vector<std::string> keyPathsEndingIn(std::string_view name);

/// The element of `names` that is most similar to `name`, which may lack its unit; empty if none is
/// similar.
[[nodiscard]] std::string nearestKey(std::string_view name, const std::vector<std::string>& names);

/// The path of the key that somebody means who says `name`: "duration" is "duration_s", "fps" is
/// "camera.fps". Empty if none is similar. Keys of named tables ("programs.NAME.model") are left
/// out.
[[nodiscard]] std::string keyMeantBy(std::string_view name);

}  // namespace lab::keys
