#pragma once

#include <string_view>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/expression_context.hpp"

namespace lab::language {

/// Whether a function draws a random number.
[[nodiscard]] bool isDraw(std::string_view function);

/// Checks a random draw, from uniform(a, b) to choose(n). Throws SyntaxError.
/// @param node a call with the right number of operands
/// @param x its operands, which are numbers
[[nodiscard]] CheckedExpression checkDraw(const ExpressionContext& context, const Expression& node,
                                          const std::vector<CheckedExpression>& x);

}  // namespace lab::language
