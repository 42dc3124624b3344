/// Parts of a program that do nothing, and so are probably mistakes.
#pragma once

#include <string>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/program_text.hpp"

namespace lab::language {

/// Warnings of parameters and state variables that nothing reads, and of phases to which no way
/// leads from the first one. A parameter of a formula of the law is read.
/// @param text of a program that compiles
/// @param ways for each phase, bit p: phase p can follow
[[nodiscard]] std::vector<Problem> unusedParts(const ProgramText& text,
                                               const std::vector<unsigned>& ways);

/// What a condition can be, by the ranges of its numbers.
struct Outcomes {
  bool yes = true;
  bool no = true;
};

[[nodiscard]] Outcomes outcomesOf(const CheckedExpression& condition);

}  // namespace lab::language
