/// Checks of the camera.
#pragma once

#include <filesystem>
#include <optional>

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that a camera other than the simulated one has a calibration and real robots to see, and
/// that the file names no source that could execute something.
/// @param directory of the experiment file; none: the text comes from a log and starts nothing
void checkCamera(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems);

}  // namespace lab::keys
