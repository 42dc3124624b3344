/// What the checks of the parts of an expression share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/expression.hpp"

namespace lab::language {

/// Notes of what can go wrong when the program runs.
struct RangeNote {
  std::size_t offset = 0;
  std::string message;
};

/// The text of an expression, with checks of the operands of its nodes, which throw SyntaxError.
class ExpressionContext {
 public:
  /// @param text,notes must outlive the context
  ExpressionContext(std::string_view text, std::vector<RangeNote>& notes)
      : text_(text), notes_(notes) {}

  /// The text of a node.
  [[nodiscard]] std::string_view textOf(const Expression& node) const;
  /// The same in quotes.
  [[nodiscard]] std::string quoted(const Expression& node) const;

  /// Notes what can go wrong with a node.
  void note(const Expression& node, const std::string& message) const;

  /// @param where for the message: "beside '+'"
  void requireType(const CheckedExpression& x, Type type, const Expression& node,
                   const std::string& where) const;
  void refuseEndless(const CheckedExpression& x, const Expression& node) const;

  /// The dimension of two numbers, which are the operand `first` of the node and the one after it.
  /// Throws if they differ.
  Dimension commonDimension(const Expression& node, std::size_t first, const CheckedExpression& a,
                            const CheckedExpression& b) const;

 private:
  std::string_view text_;
  std::vector<RangeNote>& notes_;
};

}  // namespace lab::language
