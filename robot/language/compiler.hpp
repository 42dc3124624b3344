#pragma once

#include "robot/dynamics/wheel_limits.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/program_text.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// Compiles a program: checks names, dimensions and ranges, computes what is constant, and writes
/// byte code. It never throws for what the text contains; `errors` says all that is wrong.
/// @param suggest for messages about unknown names
[[nodiscard]] CompiledProgram compile(const ProgramText& text,
                                      const dynamics::WheelLimits& limits = dynamics::WheelLimits(),
                                      Suggest suggest = nullptr);

}  // namespace lab::language
