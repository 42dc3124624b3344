/// Checks of the light script's order in time and of the rules that end a run.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/files/file_problems.hpp"
#include "common/programs/law_knowledge.hpp"

namespace lab::keys {

/// Checks that the steps follow each other and that their conditions can come true. The form has at
/// least one step.
/// @param laws which numbers are measured of which program
void checkScript(const ExperimentForm& form, const LawKnowledge& laws, Problems& problems);

/// Checks that the rules that end the run early can come true.
void checkStopRules(const ExperimentForm& form, const LawKnowledge& laws, Problems& problems);

}  // namespace lab::keys
