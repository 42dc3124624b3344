/// A program whose names, types and dimensions are right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/expression_context.hpp"

namespace lab::language {

/// The checked expressions of a phase.
struct CheckedPhase {
  std::vector<std::pair<std::uint8_t, CheckedExpression>> set;  ///< State variable, new value.
  bool wheels = false;  ///< The speeds are those of the left and the right wheel.
  CheckedExpression first;
  CheckedExpression second;
  CheckedExpression hold;
  CheckedExpression next;
  std::optional<CheckedExpression> until;
  CheckedExpression then;

  /// Bit p: phase p can follow.
  [[nodiscard]] unsigned ways() const { return next.phases | (until ? then.phases : 0U); }
};

/// The checked expressions of a program.
struct CheckedProgram {
  std::vector<Parameter> parameters;
  std::vector<Parameter> law;             ///< Parameters of the closed form that the text names.
  std::vector<std::string> states;        ///< Names, by number.
  std::vector<CheckedExpression> starts;  ///< Of the state variables.
  std::vector<CheckedPhase> phases;
  std::map<std::string, std::vector<RangeNote>> notes;  ///< By key.
};

}  // namespace lab::language
