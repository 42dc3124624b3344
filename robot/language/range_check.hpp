#pragma once

#include "robot/dynamics/wheel_limits.hpp"
#include "robot/language/checked_program.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/program_text.hpp"

namespace lab::language {

/// Finds wheel speeds and holds that are or can be out of a robot's reach, and conditions that are
/// always or never true.
/// @param result gets ranges of phases, errors, warnings and unused parts
void checkRanges(const ProgramText& text, const CheckedProgram& program,
                 const dynamics::WheelLimits& limits, CompiledProgram& result);

}  // namespace lab::language
