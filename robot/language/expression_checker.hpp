#pragma once

#include <string_view>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/expression_context.hpp"
#include "robot/language/scope.hpp"

namespace lab::language {

/// Checks an expression. Throws SyntaxError where it is wrong. Appends to `notes` what can only
/// saturate when the program runs.
/// @param wanted what it shall be, for messages; another type is no error here
[[nodiscard]] CheckedExpression checkExpression(std::string_view text, const Expression& expression,
                                                const Scope& scope, std::vector<RangeNote>& notes,
                                                Type wanted = Type::kNumber);

}  // namespace lab::language
