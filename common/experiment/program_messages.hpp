/// Robot programs as messages and back, and their names. The only place that converts between
/// program_t and dynamics::RobotProgram.
#pragma once

#include <cstdint>
#include <lab/program_t.hpp>
#include <string>

#include "common/experiment/experiment.hpp"
#include "robot/dynamics/robot_program.hpp"

namespace lab {

[[nodiscard]] program_t toMessage(const dynamics::RobotProgram& program);

/// A `kind` that program_t does not define becomes ProgramKind::kNone.
[[nodiscard]] dynamics::RobotProgram toProgram(const program_t& message);

/// The name that the experiment gives to this program, or its model's where it has none.
[[nodiscard]] std::string programName(const Experiment& experiment, const program_t& program);

/// "ABP", "noisy ABP", "BP", "RTP", "wheels", "standing".
/// @param kind as in program_t
[[nodiscard]] std::string modelName(std::int8_t kind);

/// Whether two programs are the same model with the same parameters.
[[nodiscard]] bool sameProgram(const program_t& a, const program_t& b);

/// Orders programs as keys of a map: by model, then parameter by parameter.
[[nodiscard]] bool orderedBefore(const program_t& a, const program_t& b);

}  // namespace lab
