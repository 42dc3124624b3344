#pragma once

#include <vector>

#include "robot/language/checked_program.hpp"
#include "robot/language/compiled_program.hpp"

namespace lab::language {

/// Warnings of holds that are too short on average for what the robot computes, which it lengthens
/// (dynamics::Machine). A short one among long ones is none of them, so ways from phase to phase
/// count that lead back to where they began.
/// @param facts of the phases, with their cost
[[nodiscard]] std::vector<Problem> shortHolds(const CheckedProgram& program,
                                              const std::vector<PhaseFacts>& facts);

}  // namespace lab::language
