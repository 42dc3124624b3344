/// Expressions whose names, types and dimensions are right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/dimension.hpp"
#include "robot/language/interval.hpp"

namespace lab::language {

/// What an expression is.
enum class Type { kNumber, kTruth, kPhase };

/// A checked expression, ready for byte code.
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

[[nodiscard]] CheckedExpression constantNumber(double value, const Dimension& dimension);

/// The value of a dynamics::Input.
[[nodiscard]] CheckedExpression inputValue(std::uint8_t input, const Dimension& dimension,
                                           const Interval& range);

/// A node with its operands; constant if all operands are.
[[nodiscard]] CheckedExpression combined(Type type, const Dimension& dimension,
                                         const Interval& range, dynamics::Opcode opcode,
                                         std::vector<CheckedExpression> children);

/// "a condition", "a number in cm/s"
[[nodiscard]] std::string typeText(const CheckedExpression& x);

/// "a number without unit", "a number in cm/s"
[[nodiscard]] std::string numberIn(const Dimension& dimension);

/// "-1 1/s"; the largest value of a number that is not constant.
[[nodiscard]] std::string valueText(const CheckedExpression& x, int digits = 4);

/// Throws SyntaxError unless the number has the dimension (or is the literal 0). `what` names it in
/// the message.
void requireDimension(const CheckedExpression& number, const Dimension& dimension,
                      const std::string& what, std::size_t offset);

}  // namespace lab::language
