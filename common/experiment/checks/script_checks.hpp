/// Checks of the light script's order in time and of the rules that end a run.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"

namespace lab::keys {

/// Checks that the steps follow each other and that their conditions can come true. The form has at
/// least one step.
void checkScript(const ExperimentForm& form, Problems& problems);

/// Checks that the rules that end the run early can come true.
void checkStopRules(const ExperimentForm& form, Problems& problems);

}  // namespace lab::keys
