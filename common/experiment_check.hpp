/// What must fit together in an experiment file, beyond the range of each number.
#pragma once

#include <filesystem>
#include <optional>

#include "common/experiment_form.hpp"
#include "common/experiment_problems.hpp"

namespace lab::keys {

/// The shorthand `program`, before it is expanded.
void checkShorthand(const ExperimentForm& form, Problems& problems);

/// The robots fit on the arena and the programs are what the wheels can do. Looks at nothing that
/// `problems` already concern.
void checkRobots(const ExperimentForm& form, Problems& problems);

/// A camera that is not the simulated one has a calibration.
void checkCamera(const ExperimentForm& form, Problems& problems);

/// The light table and the light script make sense.
/// @param directory of the image files; without it nobody looks for them.
void checkLight(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                Problems& problems);

}  // namespace lab::keys
