/// The shipped programs of motion (programs/), which are part of every executable.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/programs/program_file.hpp"

namespace lab {

/// Their names, sorted.
[[nodiscard]] std::vector<std::string> shippedProgramNames();

/// The TOML text of a shipped program; nothing if there is none of that name.
[[nodiscard]] std::optional<std::string> shippedProgramToml(const std::string& name);

/// The shipped program `name`; nothing if there is none.
[[nodiscard]] std::optional<language::ProgramText> shippedProgramText(const std::string& name);

/// A shipped program with other parameters, compiled.
/// @param changes {"v", "5 cm/s"}
/// @throws ExperimentError if there is no such program, or its parameters are impossible
[[nodiscard]] Program shippedProgram(const std::string& name,
                                     const std::vector<language::NamedText>& changes = {},
                                     const dynamics::WheelLimits& limits = dynamics::WheelLimits());

}  // namespace lab
