#include "robot/language/expression_context.hpp"

namespace lab::language {

std::string_view ExpressionContext::textOf(const Expression& node) const {
  return text_.substr(node.offset, node.length);
}

std::string ExpressionContext::quoted(const Expression& node) const {
  return "'" + std::string(textOf(node)) + "'";
}

void ExpressionContext::note(const Expression& node, const std::string& message) const {
  notes_.push_back({node.offset, message});
}

void ExpressionContext::requireType(const CheckedExpression& x, Type type, const Expression& node,
                                    const std::string& where) const {
  if (x.type == type) {
    return;
  }
  CheckedExpression expected;
  expected.type = type;
  const std::string wanted = type == Type::kNumber ? "a number" : typeText(expected);
  throw SyntaxError(node.offset,
                    quoted(node) + " is " + typeText(x) + ", expected " + wanted + " " + where);
}

void ExpressionContext::refuseEndless(const CheckedExpression& x, const Expression& node) const {
  if (x.endless) {
    throw SyntaxError(node.offset, "'forever' can only stand alone, as a hold");
  }
}

Dimension ExpressionContext::commonDimension(const Expression& node, std::size_t first,
                                             const CheckedExpression& a,
                                             const CheckedExpression& b) const {
  if (a.any_dimension) {
    return b.dimension;
  }
  if (!b.any_dimension && !(a.dimension == b.dimension)) {
    const Expression& left = node.operands[first];
    const Expression& right = node.operands[first + 1];
    throw SyntaxError(right.offset, quoted(right) + " is " + typeText(b) + ", expected " +
                                        typeText(a) + " like " + quoted(left));
  }
  return a.dimension;
}

}  // namespace lab::language
