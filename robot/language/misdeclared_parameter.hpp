#pragma once

#include <optional>

#include "robot/language/program_checker.hpp"

namespace lab::language {

/// If all that is wrong are units, and another unit of one parameter makes all right, the mistake
/// is that parameter's: it is reported there, with the first of its uses.
/// @param checker with errors
[[nodiscard]] std::optional<Problem> misdeclaredParameter(const ProgramText& text,
                                                          const ProgramChecker& checker);

}  // namespace lab::language
