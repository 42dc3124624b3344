#pragma once

#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/expression_context.hpp"

namespace lab::language {

/// Checks the call of a function that draws nothing, from abs(x) to clamp(x, low, high); `if` and
/// the numbered sensors are not among them. Throws SyntaxError.
/// @param node a call with the right number of operands
/// @param x its operands, which are numbers
[[nodiscard]] CheckedExpression checkFunction(const ExpressionContext& context,
                                              const Expression& node,
                                              const std::vector<CheckedExpression>& x);

}  // namespace lab::language
