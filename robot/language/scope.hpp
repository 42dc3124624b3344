/// The names of a program.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// A state variable as the compiler knows it.
struct StateVariable {
  std::uint8_t number = 0;
  Dimension dimension;
  Interval range;  ///< All values that it can have.
};

/// The names that an expression can use besides those of the language.
struct Scope {
  std::map<std::string, CheckedExpression, std::less<>> parameters;
  std::map<std::string, StateVariable, std::less<>> states;
  std::map<std::string, std::uint8_t, std::less<>> phases;
  Suggest suggest = nullptr;
  /// The end of a message about an unknown name: what there is.
  [[nodiscard]] std::string knownNames(std::string_view unknown) const;
  /// The same where only a phase can stand.
  [[nodiscard]] std::string knownPhases(std::string_view unknown) const;
};

/// "run, tumble"
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

}  // namespace lab::language
