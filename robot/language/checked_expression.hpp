#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/sensors.hpp"
#include "robot/language/dimension.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/interval.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// What an expression is.
enum class Type { kNumber, kTruth, kPhase };

/// An expression whose names, types and dimensions are right, ready for byte code.
struct CheckedExpression {
  Type type = Type::kNumber;
  Dimension dimension;
  bool any_dimension = false;  ///< The literal 0, which fits every dimension.
  bool constant = false;       ///< Its value is `range.low`.
  bool endless = false;        ///< The name "forever".
  Interval range;              ///< Of a number or a truth value.
  unsigned phases = 0;         ///< Bit p: the value can be phase p.

  std::uint8_t opcode = 0;                  ///< 0 for constants.
  std::uint8_t operand = 0;                 ///< Of kLoad and kRead.
  std::vector<CheckedExpression> children;  ///< Evaluated in this order before the opcode.
};

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

/// Notes of what can go wrong when the program runs.
struct RangeNote {
  std::size_t offset = 0;
  std::string message;
};

/// Checks an expression. Throws SyntaxError where it is wrong. Appends to `notes` what can only
/// saturate when the program runs.
/// @param wanted what it shall be, for messages; another type is no error here
[[nodiscard]] CheckedExpression checkExpression(std::string_view text, const Expression& expression,
                                                const Scope& scope, std::vector<RangeNote>& notes,
                                                Type wanted = Type::kNumber);

/// Throws SyntaxError unless the number has the dimension (or is the literal 0). `what` names it in
/// the message.
void requireDimension(const CheckedExpression& number, const Dimension& dimension,
                      const std::string& what, std::size_t offset);

/// Whether the language gives this name a meaning, so that no program may. Of the functions only
/// `sign` is free: without a bracket it is a name, and a usual one.
[[nodiscard]] bool isReserved(std::string_view name);

/// What texts of programs call a dynamics::Input: "light", "ir(0)", "sense(3)".
[[nodiscard]] std::string inputName(std::uint8_t input);

}  // namespace lab::language
