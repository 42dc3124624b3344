/// Checks of the camera.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that a camera other than the simulated one has a calibration and real robots to see.
void checkCamera(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
