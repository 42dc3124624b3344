#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot/dynamics/wheel_limits.hpp"
#include "robot/language/dimension.hpp"
#include "robot/language/interval.hpp"
#include "robot/language/program_text.hpp"
#include "robot/language/suggestion.hpp"

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

/// Whether a key of ProgramText::law is a formula; the others belong to a closed form.
[[nodiscard]] bool isFormula(const std::string& law_key);

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

/// Compiles a program: checks names, dimensions and ranges, computes what is constant, and writes
/// byte code. It never throws for what the text contains; `errors` says all that is wrong.
/// @param suggest for messages about unknown names
[[nodiscard]] CompiledProgram compile(const ProgramText& text,
                                      const dynamics::WheelLimits& limits = dynamics::WheelLimits(),
                                      Suggest suggest = nullptr);

}  // namespace lab::language
