/// Checks of the light table and of the light script as a whole.
#pragma once

#include <filesystem>
#include <optional>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"
#include "common/programs/law_knowledge.hpp"

namespace lab::keys {

/// Checks the shorthand key `program`, before it is expanded.
void checkShorthand(const ExperimentForm& form, Problems& problems);

/// Checks the light table, the light script and its layers.
/// @param directory of the image files; if none is given, image files are not looked for
void checkLight(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                const LawKnowledge& laws, Problems& problems);

}  // namespace lab::keys
