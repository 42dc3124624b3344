#pragma once

#include "robot/language/checked_program.hpp"
#include "robot/language/compiled_program.hpp"

namespace lab::language {

/// Writes the byte code of a program, or says why a robot cannot execute it.
/// @param result has the names of the phases; gets code, hash, costs, errors and warnings
void writeProgramCode(const CheckedProgram& program, CompiledProgram& result);

}  // namespace lab::language
