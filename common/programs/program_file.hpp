/// Programs of motion in TOML: files of their own, and tables of experiment files.
#pragma once

#include <string>
#include <string_view>

#include "robot/dynamics/wheel_limits.hpp"
#include "robot/language/compiler.hpp"
#include "robot/language/program_text.hpp"

namespace lab {

/// A program with all that its file says.
struct ProgramFile {
  language::ProgramText text;
  language::CompiledProgram compiled;
};

/// Reads and compiles a program (docs/programs.md).
/// @param text the TOML document
/// @param file its name, for messages
/// @param name of the program
/// @throws ExperimentError that names every problem with line, column, what was found and what is
///   expected
[[nodiscard]] ProgramFile readProgram(
    std::string_view text, const std::string& file, const std::string& name,
    const dynamics::WheelLimits& limits = dynamics::WheelLimits());

}  // namespace lab
