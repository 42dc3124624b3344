#include "robot/language/function_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace lab::language {
namespace {

CheckedExpression squareRootOf(const ExpressionContext& context, const Expression& node,
                               const CheckedExpression& x) {
  const auto dimension = squareRoot(x.dimension);
  const Expression& operand = node.operands[0];
  if (!dimension) {
    throw SyntaxError(operand.offset, context.quoted(operand) + " is " + typeText(x) +
                                          ", expected a square such as cm^2");
  }
  if (x.range.high < 0) {
    throw SyntaxError(operand.offset,
                      "square root of a negative number: " + context.quoted(operand));
  }
  if (x.range.low < 0) {
    context.note(operand, context.quoted(operand) +
                              " can be negative; its square root is then 0 and is "
                              "counted");
  }
  const auto root = [](double value) { return std::sqrt(std::max(0.0, value)); };
  return combined(Type::kNumber, *dimension, mapped(x.range, root), dynamics::kSqrt, {x});
}

}  // namespace

CheckedExpression checkFunction(const ExpressionContext& context, const Expression& node,
                                const std::vector<CheckedExpression>& x) {
  const std::string& name = node.name;
  if (name == "abs") {
    return combined(Type::kNumber, x[0].dimension, absolute(x[0].range), dynamics::kAbs, {x[0]});
  }
  if (name == "sign") {
    const auto sign = [](double value) { return value > 0 ? 1.0 : value < 0 ? -1.0 : 0.0; };
    return combined(Type::kNumber, kPure, mapped(x[0].range, sign), dynamics::kSign, {x[0]});
  }
  if (name == "sqrt") {
    return squareRootOf(context, node, x[0]);
  }
  if (name == "sin" || name == "cos") {
    requireDimension(x[0], kPure, "the angle " + context.quoted(node.operands[0]),
                     node.operands[0].offset);
    Interval range = bounds(-1, 1);
    if (x[0].constant) {
      const double value = name == "sin" ? std::sin(x[0].range.low) : std::cos(x[0].range.low);
      range = {value, value, true};
    }
    return combined(Type::kNumber, kPure, range, name == "sin" ? dynamics::kSin : dynamics::kCos,
                    {x[0]});
  }
  const Dimension common = context.commonDimension(node, 0, x[0], x[1]);
  if (name == "atan2") {
    Interval range = bounds(-std::numbers::pi, std::numbers::pi);
    if (x[0].constant && x[1].constant) {
      const double value = std::atan2(x[0].range.low, x[1].range.low);
      range = {value, value, true};
    }
    return combined(Type::kNumber, kPure, range, dynamics::kAtan2, {x[0], x[1]});
  }
  if (name == "clamp") {
    context.commonDimension(node, 1, x[1], x[2]);
    const CheckedExpression upper = combined(Type::kNumber, common, smaller(x[0].range, x[2].range),
                                             dynamics::kMin, {x[0], x[2]});
    return combined(Type::kNumber, common, larger(upper.range, x[1].range), dynamics::kMax,
                    {upper, x[1]});
  }
  const bool least = name == "min";
  return combined(Type::kNumber, common,
                  least ? smaller(x[0].range, x[1].range) : larger(x[0].range, x[1].range),
                  least ? dynamics::kMin : dynamics::kMax, {x[0], x[1]});
}

}  // namespace lab::language
