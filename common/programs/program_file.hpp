/// Programs of motion in TOML: files of their own, and tables of experiment files.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/programs/law_knowledge.hpp"
#include "common/programs/program.hpp"
#include "robot/dynamics/wheel_limits.hpp"
#include "robot/language/compiler.hpp"
#include "robot/language/program_text.hpp"

namespace lab {

/// For programs whose wheel speeds are checked elsewhere.
inline constexpr dynamics::WheelLimits kWidestWheels{1e4, 0.075};

/// A program with all that its file says.
struct ProgramFile {
  language::ProgramText text;
  language::CompiledProgram compiled;
};

/// Finds the program that `model` of an experiment file names.
/// @return its text; nothing if there is none
/// @throws ExperimentError if a file cannot be read
using ModelLookup = std::function<std::optional<language::ProgramText>(const std::string& model)>;

/// Reads and compiles a program (docs/programs.md).
/// @param text the TOML document, at most 100 kB
/// @param file its name, for messages
/// @param name of the program
/// @param check_law of the program's law; empty: it is not checked
/// @throws ExperimentError that names every problem with line, column, what was found and what is
///   expected
[[nodiscard]] ProgramFile readProgram(std::string_view text, const std::string& file,
                                      const std::string& name,
                                      const dynamics::WheelLimits& limits = dynamics::WheelLimits(),
                                      const LawCheck& check_law = {});

/// The program as the lab passes it on.
[[nodiscard]] Program toProgram(const ProgramFile& file);

/// The text of a program. readProgram() gives an equal one.
/// @param path before the names of its tables: "programs.fast." in an experiment file
[[nodiscard]] std::string programToml(const language::ProgramText& program,
                                      const std::string& path = {});

}  // namespace lab
