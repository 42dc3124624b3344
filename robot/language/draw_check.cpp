#include "robot/language/draw_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "robot/language/number_text.hpp"

namespace lab::language {
namespace {

constexpr double kLongestExponential = 22.2;  // -ln(2^-32), the largest draw over its mean
constexpr double kLargestNormal = 6.67;       // sqrt(2 * 22.2), the largest draw over its deviation

constexpr std::array<std::string_view, 6> kDraws{"uniform", "normal", "exponential",
                                                 "pareto",  "chance", "choose"};

/// A draw without a bound that programs reach: it counts with the mean (Pareto: the minimum).
Interval unbounded(Interval range, const Interval& mean) {
  range.sure_low = std::clamp(mean.sure_low, range.low, range.high);
  range.sure_high = std::clamp(mean.sure_high, range.low, range.high);
  return range;
}

CheckedExpression choose(const ExpressionContext& context, const Expression& node,
                         const CheckedExpression& x) {
  const Expression& operand = node.operands[0];
  requireDimension(x, kPure, context.quoted(operand), operand.offset);
  if (x.range.high < 1 || (x.constant && x.range.low != std::floor(x.range.low))) {
    throw SyntaxError(operand.offset, "choose(n) found n = " + context.quoted(operand) +
                                          ", expected a whole number of 1 or more");
  }
  Interval range(0, std::floor(x.range.high) - 1);
  range.sure_high = std::max(0.0, std::floor(x.range.sure_high) - 1);
  return combined(Type::kNumber, kPure, range, dynamics::kChoose, {x});
}

CheckedExpression chance(const ExpressionContext& context, const Expression& node,
                         const CheckedExpression& x) {
  const Expression& operand = node.operands[0];
  requireDimension(x, kPure, "the probability " + context.quoted(operand), operand.offset);
  const bool outside = x.range.low < 0 || x.range.high > 1;
  if (outside && (x.constant || x.range.high < 0 || x.range.low > 1)) {
    throw SyntaxError(operand.offset,
                      "the probability " + context.quoted(operand) + " is " +
                          numberText(x.range.low, digitsBeside({0, 1}, x.range.low)) +
                          ", expected 0 to 1");
  }
  if (outside) {
    context.note(operand, "the probability " + context.quoted(operand) +
                              " can lie outside 0 to 1, where it counts as 0 or 1");
  }
  const bool both = x.constant && x.range.low > 0 && x.range.low < 1;
  return combined(Type::kTruth, kPure, Interval{0, 1, both}, dynamics::kChance, {x});
}

void requirePositive(const ExpressionContext& context, const CheckedExpression& x,
                     const Expression& node, const std::string& what) {
  if (x.range.high <= 0) {
    throw SyntaxError(node.offset, what + " is " + context.quoted(node) + ", expected more than 0");
  }
  if (x.range.low <= 0) {
    context.note(node, what + " " + context.quoted(node) +
                           " can be 0 or less; the draw is then its limit and is "
                           "counted");
  }
}

}  // namespace

bool isDraw(std::string_view function) {
  return std::ranges::find(kDraws, function) != kDraws.end();
}

CheckedExpression checkDraw(const ExpressionContext& context, const Expression& node,
                            const std::vector<CheckedExpression>& x) {
  const std::string& name = node.name;
  CheckedExpression result;
  if (name == "uniform") {
    const Dimension common = context.commonDimension(node, 0, x[0], x[1]);
    if (x[0].range.low > x[1].range.high) {
      const int digits = digitsBeside({x[1].range.high}, x[0].range.high);
      throw SyntaxError(node.offset,
                        "the draw begins above its end: " + context.quoted(node.operands[0]) +
                            " is " + valueText(x[0], digits) + ", " +
                            context.quoted(node.operands[1]) + " is " + valueText(x[1], digits) +
                            ", expected uniform(low, high)");
    }
    result = combined(Type::kNumber, common, join(x[0].range, x[1].range), dynamics::kUniform,
                      {x[0], x[1]});
  } else if (name == "normal") {
    const Dimension common = context.commonDimension(node, 0, x[0], x[1]);
    if (x[1].range.high < 0) {
      throw SyntaxError(node.operands[1].offset, "the deviation " +
                                                     context.quoted(node.operands[1]) + " is " +
                                                     valueText(x[1]) + ", expected 0 or more");
    }
    const double reach = kLargestNormal * x[1].range.magnitude();
    result = combined(Type::kNumber, common,
                      unbounded(sum(x[0].range, bounds(-reach, reach)), x[0].range),
                      dynamics::kNormal, {x[0], x[1]});
  } else if (name == "exponential") {
    requirePositive(context, x[0], node.operands[0], "the mean of an exponential draw");
    result = combined(Type::kNumber, x[0].dimension,
                      unbounded(bounds(0, kLongestExponential * x[0].range.high), x[0].range),
                      dynamics::kExponential, {x[0]});
  } else if (name == "pareto") {
    requirePositive(context, x[0], node.operands[0], "the minimum of a Pareto draw");
    requirePositive(context, x[1], node.operands[1], "the exponent of a Pareto draw");
    requireDimension(x[1], kPure, "the exponent " + context.quoted(node.operands[1]),
                     node.operands[1].offset);
    const double longest = x[1].range.low > 0
                               ? x[0].range.high * std::exp(kLongestExponential / x[1].range.low)
                               : kLargestNumber;
    result = combined(Type::kNumber, x[0].dimension,
                      unbounded(bounds(x[0].range.low, longest), x[0].range), dynamics::kPareto,
                      {x[0], x[1]});
  } else if (name == "chance") {
    result = chance(context, node, x[0]);
  } else {
    result = choose(context, node, x[0]);
  }
  result.constant = false;
  return result;
}

}  // namespace lab::language
