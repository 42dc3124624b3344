/// Checks of the light script's layers.
#pragma once

#include <filesystem>
#include <optional>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that each layer of each step can be painted and can change as its keys say.
/// @param directory of the image files; if none is given, image files are not looked for
void checkLayers(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems);

}  // namespace lab::keys
