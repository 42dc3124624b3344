/// What the compiler gives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "robot/language/dimension.hpp"
#include "robot/language/interval.hpp"

namespace lab::language {

/// Something wrong in a program, and where.
struct Problem {
  std::string key;         ///< "parameters.v", "phases.run.forward"; empty: the program as a whole.
  std::size_t offset = 0;  ///< Character in the text of the key.
  std::string message;     ///< One line: what was found, what was expected, the way out.
};

/// A parameter's value in the units of programs (cm, s, rad, volt).
struct Parameter {
  std::string name;
  double value = 0;
  Dimension dimension;
};

/// What is known of a phase before it runs.
struct PhaseFacts {
  std::string name;
  Interval left;                   ///< Wheel speed [cm/s].
  Interval right;                  ///< Wheel speed [cm/s].
  Interval hold;                   ///< [s]; kLargestNumber stands for a hold without end.
  unsigned cost = 0;               ///< Of its evaluation block, at most [cycles on the robot].
  unsigned interruption_cost = 0;  ///< Of its interruption block [cycles].
};

/// A compiled program. Without errors, `code` is accepted by dynamics::checkByteCode().
struct CompiledProgram {
  std::string name;
  std::vector<std::uint8_t> code;
  std::uint32_t hash = 0;
  std::vector<Parameter> parameters;
  std::vector<Parameter> law;       ///< Parameters of the closed form that the text names.
  std::vector<std::string> states;  ///< Names, by number.
  std::vector<PhaseFacts> phases;
  std::vector<Problem> errors;
  std::vector<Problem> warnings;  ///< What saturates and is counted when it happens.
  std::vector<Problem> unused;    ///< Parts that do nothing, which are probably mistakes.

  [[nodiscard]] bool ok() const { return errors.empty(); }
};

}  // namespace lab::language
