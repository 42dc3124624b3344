/// What the analyzer knows of laws, for the checks of experiment files.
#pragma once

#include "common/programs/law_knowledge.hpp"

namespace lab::analysis {

[[nodiscard]] LawKnowledge lawKnowledge();

}  // namespace lab::analysis
