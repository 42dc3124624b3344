/// Checks of the robots: ids, serial lines, places, reversals.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that the robots fit on the arena, and that their lines and reversals are possible. Parts
/// of the file that already have a problem are skipped.
void checkRobots(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
