/// Checks of the robot programs.
#pragma once

#include <string>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that no two programs are the same.
void checkPrograms(const ExperimentForm& form, Problems& problems);

/// Checks that `name` is the name of a program of this file.
/// @param path of the key that holds the name
void checkProgramName(const ExperimentForm& form, const std::string& path, const std::string& name,
                      Problems& problems);

/// Whether the keys that limit the wheels have no problem.
[[nodiscard]] bool wheelsAreKnown(const Problems& problems);

}  // namespace lab::keys
