#include "robot/language/checked_expression.hpp"

#include <algorithm>
#include <utility>

#include "robot/language/expression.hpp"
#include "robot/language/number_text.hpp"

namespace lab::language {

CheckedExpression constantNumber(double value, const Dimension& dimension) {
  CheckedExpression result;
  result.dimension = dimension;
  result.constant = true;
  result.range = {value, value, true};
  return result;
}

CheckedExpression inputValue(std::uint8_t input, const Dimension& dimension,
                             const Interval& range) {
  CheckedExpression result;
  result.dimension = dimension;
  result.range = range;
  result.opcode = dynamics::kRead;
  result.operand = input;
  return result;
}

CheckedExpression combined(Type type, const Dimension& dimension, const Interval& range,
                           dynamics::Opcode opcode, std::vector<CheckedExpression> children) {
  CheckedExpression result;
  result.type = type;
  result.dimension = dimension;
  result.range = range;
  result.opcode = opcode;
  result.constant = type == Type::kNumber && range.isPoint() &&
                    std::ranges::all_of(children, &CheckedExpression::constant);
  result.children = std::move(children);
  return result;
}

std::string typeText(const CheckedExpression& x) {
  switch (x.type) {
    case Type::kTruth:
      return "a condition";
    case Type::kPhase:
      return "a phase";
    case Type::kNumber:
      break;
  }
  return numberIn(x.dimension);
}

std::string numberIn(const Dimension& dimension) {
  return dimension == kPure ? "a number without unit" : "a number in " + unitText(dimension);
}

std::string valueText(const CheckedExpression& x, int digits) {
  return numberText(x.range.high, digits) +
         (x.dimension == kPure ? "" : " " + unitText(x.dimension));
}

void requireDimension(const CheckedExpression& number, const Dimension& dimension,
                      const std::string& what, std::size_t offset) {
  if (number.any_dimension || number.dimension == dimension) {
    return;
  }
  throw SyntaxError(offset, what + " is " + typeText(number) + ", expected " + numberIn(dimension));
}

}  // namespace lab::language
