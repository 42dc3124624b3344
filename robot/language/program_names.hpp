#pragma once

#include <string_view>
#include <vector>

#include "robot/language/compiled_program.hpp"
#include "robot/language/program_text.hpp"

namespace lab::language {

/// Whether a text has the form of a name.
[[nodiscard]] bool isName(std::string_view text);

/// What is wrong with the names of parameters, state variables and phases, and with their numbers.
[[nodiscard]] std::vector<Problem> problemsOfNames(const ProgramText& text);

}  // namespace lab::language
