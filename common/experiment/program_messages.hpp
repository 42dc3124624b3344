/// Programs of motion as messages and back.
#pragma once

#include <cstdint>
#include <lab/program_id_t.hpp>
#include <lab/program_t.hpp>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/programs/program.hpp"

namespace lab {

/// What a message calls a robot without a program.
inline constexpr const char* kStanding = "standing";

/// The name of no program that a robot reports while the host sets its wheel speeds.
inline constexpr const char* kDrivenByHost = "driven";

/// The hash of a program in an old log that cannot be compiled; message_values.hpp refuses it.
inline constexpr std::int64_t kImpossibleHash = -1;

[[nodiscard]] program_id_t toId(const Program& program);
[[nodiscard]] program_t toMessage(const Program& program);

/// The program of a definition.
/// @throws ExperimentError if its text is none, is too long, or is not the text of its byte code
[[nodiscard]] Program toProgram(const program_t& message);

/// The experiment's program with this byte code; null if it has none.
[[nodiscard]] const Program* findProgram(const Experiment& experiment, const program_id_t& id);

/// The name that the experiment gives to this program, or the one in the message, or
/// "standing".
[[nodiscard]] std::string programName(const Experiment& experiment, const program_id_t& id);

}  // namespace lab
