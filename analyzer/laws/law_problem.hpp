/// What is wrong with the law that a program names, found before it runs.
#pragma once

#include <vector>

#include "common/programs/law_knowledge.hpp"

namespace lab::analysis {

/// @param text of a program, compiled: it has no errors
/// @param lags over which own formulas must be finite and not negative
/// @return one problem a key: an unknown closed form, parameters that it lacks, has too many of, or
///   in another unit; formulas that cannot be a mean square or a diffusivity. Whether the motion
///   follows the law is not checked.
[[nodiscard]] std::vector<language::Problem> lawProblems(const language::ProgramText& text,
                                                         const language::CompiledProgram& compiled,
                                                         const LagRange& lags);

}  // namespace lab::analysis
