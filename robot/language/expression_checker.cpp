#include "robot/language/expression_checker.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/sensors.hpp"
#include "robot/language/builtins.hpp"
#include "robot/language/draw_check.hpp"
#include "robot/language/function_check.hpp"

namespace lab::language {
namespace {

class ExpressionChecker {
 public:
  ExpressionChecker(const ExpressionContext& context, const Scope& scope, Type wanted)
      : context_(context), scope_(scope), phase_wanted_(wanted == Type::kPhase) {}

  CheckedExpression check(const Expression& node) {
    const bool branches =
        node.kind == Expression::kName || (node.kind == Expression::kCall && node.name == "if");
    const bool wanted = std::exchange(phase_wanted_, phase_wanted_ && branches);
    CheckedExpression result = checkNode(node);
    phase_wanted_ = wanted;
    if (result.type == Type::kNumber && result.constant && !result.endless) {
      limit(result.range.low, node);
    }
    return result;
  }

 private:
  CheckedExpression checkNode(const Expression& node) {
    switch (node.kind) {
      case Expression::kNumber: {
        CheckedExpression number = constantNumber(node.value, kPure);
        number.any_dimension = node.value == 0;
        return number;
      }
      case Expression::kName:
        return checkName(node);
      case Expression::kUnary:
        return checkUnary(node);
      case Expression::kBinary:
        return checkBinary(node);
      case Expression::kCall:
        return checkCall(node);
    }
    throw SyntaxError(node.offset, "not an expression");
  }

  static void limit(double value, const Expression& node) {
    if (std::abs(value) >= kLargestNumber) {
      throw SyntaxError(node.offset,
                        "the value is too large: numbers (in cm, s, rad) lie within +-32768");
    }
  }

  CheckedExpression checkName(const Expression& node) {
    if (const auto parameter = scope_.parameters.find(node.name);
        parameter != scope_.parameters.end()) {
      return parameter->second;
    }
    if (const auto state = scope_.states.find(node.name); state != scope_.states.end()) {
      CheckedExpression result;
      result.dimension = state->second.dimension;
      result.range = state->second.range;
      result.opcode = dynamics::kLoad;
      result.operand = state->second.number;
      return result;
    }
    if (const auto phase = scope_.phases.find(node.name); phase != scope_.phases.end()) {
      CheckedExpression result;
      result.type = Type::kPhase;
      result.constant = true;
      result.range = {static_cast<double>(phase->second), static_cast<double>(phase->second), true};
      result.phases = 1U << phase->second;
      return result;
    }
    if (const Sensor* sensor = sensorNamed(node.name)) {
      return inputValue(sensor->input, sensor->dimension, bounds(sensor->low, sensor->high));
    }
    if (node.name == "pi") {
      return constantNumber(std::numbers::pi, kPure);
    }
    if (node.name == "forever") {
      CheckedExpression result = constantNumber(kLargestNumber, kTime);
      result.endless = true;
      return result;
    }
    if (const auto unit = unitNamed(node.name)) {
      return constantNumber(unit->size, unit->dimension);
    }
    if (const BuiltinFunction* function = functionNamed(node.name)) {
      throw SyntaxError(node.offset,
                        "'" + node.name + "' is a function: write " + std::string(function->usage));
    }
    if (phase_wanted_) {
      throw SyntaxError(node.offset,
                        "unknown name '" + node.name + "'" + scope_.knownPhases(node.name));
    }
    throw SyntaxError(node.offset,
                      "unknown name '" + node.name + "'" + scope_.knownNames(node.name));
  }

  CheckedExpression checkUnary(const Expression& node) {
    CheckedExpression operand = check(node.operands[0]);
    if (node.name == "not") {
      context_.requireType(operand, Type::kTruth, node.operands[0], "after 'not'");
      return combined(Type::kTruth, kPure, Interval{0, 1, false}, dynamics::kNot, {operand});
    }
    context_.requireType(operand, Type::kNumber, node.operands[0], "after '-'");
    context_.refuseEndless(operand, node.operands[0]);
    CheckedExpression result = combined(Type::kNumber, operand.dimension, negative(operand.range),
                                        dynamics::kNegate, {operand});
    result.any_dimension = operand.any_dimension;
    return result;
  }

  CheckedExpression checkBinary(const Expression& node) {
    CheckedExpression a = check(node.operands[0]);
    CheckedExpression b = check(node.operands[1]);
    const std::string where = "beside '" + node.name + "'";
    if (node.name == "and" || node.name == "or") {
      context_.requireType(a, Type::kTruth, node.operands[0], where);
      context_.requireType(b, Type::kTruth, node.operands[1], where);
      return combined(Type::kTruth, kPure, Interval{0, 1, false},
                      node.name == "and" ? dynamics::kAnd : dynamics::kOr, {a, b});
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const CheckedExpression& operand = i == 0 ? a : b;
      context_.requireType(operand, Type::kNumber, node.operands[i], where);
      context_.refuseEndless(operand, node.operands[i]);
    }
    if (node.name == "*") {
      return combined(Type::kNumber, product(a.dimension, b.dimension), product(a.range, b.range),
                      dynamics::kMultiply, {a, b});
    }
    if (node.name == "/") {
      return divide(node, a, b);
    }
    const Dimension common = context_.commonDimension(node, 0, a, b);
    if (node.name == "+" || node.name == "-") {
      const bool plus = node.name == "+";
      return combined(Type::kNumber, common, sum(a.range, plus ? b.range : negative(b.range)),
                      plus ? dynamics::kAdd : dynamics::kSubtract, {a, b});
    }
    return combined(Type::kTruth, kPure, Interval{0, 1, false}, comparison(node.name), {a, b});
  }

  static dynamics::Opcode comparison(const std::string& symbol) {
    if (symbol == "<") return dynamics::kLess;
    if (symbol == "<=") return dynamics::kLessOrEqual;
    if (symbol == ">") return dynamics::kGreater;
    if (symbol == ">=") return dynamics::kGreaterEqual;
    return symbol == "==" ? dynamics::kEqual : dynamics::kNotEqual;
  }

  CheckedExpression divide(const Expression& node, const CheckedExpression& a,
                           const CheckedExpression& b) {
    if (b.constant && b.range.low == 0) {
      throw SyntaxError(node.operands[1].offset,
                        "division by zero: " + context_.quoted(node.operands[1]) + " is 0");
    }
    if (b.range.contains(0)) {
      context_.note(node.operands[1],
                    context_.quoted(node.operands[1]) +
                        " can be 0; a division by 0 gives the largest number and is counted");
    }
    return combined(Type::kNumber, quotient(a.dimension, b.dimension), quotient(a.range, b.range),
                    dynamics::kDivide, {a, b});
  }

  CheckedExpression checkCall(const Expression& node) {
    const BuiltinFunction* function = functionNamed(node.name);
    if (function == nullptr) {
      const std::string_view instead = insteadOfFunction(node.name);
      throw SyntaxError(
          node.offset, "unknown function '" + node.name + "'; there are " +
                           listed(functionNames()) +
                           (instead.empty() ? suggestion(scope_.suggest, node.name, functionNames())
                                            : "; write " + std::string(instead)));
    }
    if (node.operands.size() != function->operands) {
      throw SyntaxError(node.offset, "'" + node.name + "' has " +
                                         std::to_string(node.operands.size()) +
                                         " arguments, expected " + std::string(function->usage) +
                                         commaAdvice(context_.textOf(node)));
    }
    std::vector<CheckedExpression> x;
    const bool wanted = phase_wanted_;
    for (const Expression& operand : node.operands) {
      phase_wanted_ = wanted && !x.empty();  // the condition of `if` is no phase
      x.push_back(check(operand));
    }
    if (node.name == "if") {
      if (wanted) {
        context_.requireType(x[1], Type::kPhase, node.operands[1], "to go to");
      }
      return select(node, x);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      context_.requireType(x[i], Type::kNumber, node.operands[i],
                           "in " + std::string(function->usage));
      context_.refuseEndless(x[i], node.operands[i]);
    }
    if (node.name == "ir" || node.name == "sense") {
      return numberedInput(node, x[0]);
    }
    return isDraw(node.name) ? checkDraw(context_, node, x) : checkFunction(context_, node, x);
  }

  CheckedExpression select(const Expression& node, std::vector<CheckedExpression>& x) {
    context_.requireType(x[0], Type::kTruth, node.operands[0], "as the first argument of 'if'");
    context_.requireType(x[2], x[1].type, node.operands[2],
                         "like " + context_.quoted(node.operands[1]));
    // Sensors and history may never let a branch be taken; a draw does.
    const Interval range =
        x[0].range.isAttained() ? join(x[1].range, x[2].range) : either(x[1].range, x[2].range);
    CheckedExpression result =
        combined(x[1].type, kPure, range, dynamics::kSelect, {x[0], x[1], x[2]});
    result.constant = false;
    result.phases = x[1].phases | x[2].phases;
    if (x[1].type == Type::kNumber) {
      result.dimension = context_.commonDimension(node, 1, x[1], x[2]);
    }
    return result;
  }

  CheckedExpression numberedInput(const Expression& node, const CheckedExpression& index) {
    const bool infrared = node.name == "ir";
    const int count = infrared ? dynamics::kIrSensors : dynamics::kSenses;
    const double number = index.range.low;
    if (!index.constant || number != std::floor(number) || number < 0 || number >= count) {
      throw SyntaxError(node.operands[0].offset, "found " + context_.quoted(node.operands[0]) +
                                                     ", expected a whole number from 0 to " +
                                                     std::to_string(count - 1));
    }
    const int first = infrared ? dynamics::kIr : dynamics::kSense;
    const auto input = static_cast<std::uint8_t>(first + static_cast<int>(number));
    return infrared ? inputValue(input, kPure, bounds(0, 1))
                    : inputValue(input, kPure, bounds(-kLargestNumber, kLargestNumber));
  }

  const ExpressionContext& context_;
  const Scope& scope_;
  bool phase_wanted_;  ///< The node shall be a phase.
};

}  // namespace

CheckedExpression checkExpression(std::string_view text, const Expression& expression,
                                  const Scope& scope, std::vector<RangeNote>& notes, Type wanted) {
  const ExpressionContext context(text, notes);
  return ExpressionChecker(context, scope, wanted).check(expression);
}

}  // namespace lab::language
