#include "robot/language/checked_expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <utility>

namespace lab::language {
namespace {

using dynamics::Opcode;

constexpr double kLongestExponential = 22.2;  // -ln(2^-32), the largest draw over its mean
constexpr double kLargestNormal = 6.67;       // sqrt(2 * 22.2), the largest draw over its deviation

struct Function {
  std::string_view name;
  std::size_t operands;
  std::string_view usage;
};

constexpr std::array<Function, 18> kFunctions{{
    {"if", 3, "if(condition, then, otherwise)"},
    {"min", 2, "min(a, b)"},
    {"max", 2, "max(a, b)"},
    {"abs", 1, "abs(x)"},
    {"sign", 1, "sign(x)"},
    {"clamp", 3, "clamp(x, low, high)"},
    {"sqrt", 1, "sqrt(x)"},
    {"sin", 1, "sin(angle)"},
    {"cos", 1, "cos(angle)"},
    {"atan2", 2, "atan2(y, x)"},
    {"uniform", 2, "uniform(a, b)"},
    {"normal", 2, "normal(mean, deviation)"},
    {"exponential", 1, "exponential(mean)"},
    {"pareto", 2, "pareto(minimum, exponent)"},
    {"chance", 1, "chance(probability)"},
    {"choose", 1, "choose(n)"},
    {"ir", 1, "ir(0) to ir(5)"},
    {"sense", 1, "sense(0) to sense(7)"},
}};

/// The one function whose name a program may use: a direction of 1 or -1 is called so.
constexpr std::string_view kFreeFunction = "sign";

/// What other languages have, and what to write here.
struct ForeignFunction {
  std::string_view name;
  std::string_view instead;
};

constexpr std::array<ForeignFunction, 12> kForeignFunctions{{
    {"rand", "uniform(0, 1)"},
    {"random", "uniform(0, 1)"},
    {"gauss", "normal(mean, deviation)"},
    {"gaussian", "normal(mean, deviation)"},
    {"randn", "normal(mean, deviation)"},
    {"bernoulli", "chance(probability)"},
    {"tan", "sin(x)/cos(x)"},
    {"atan", "atan2(y, x)"},
    {"arctan", "atan2(y, x)"},
    {"exp", "it in a formula of law only"},
    {"log", "it in a formula of law only"},
    {"pow", "a product such as x*x, or pow(x, n) in a formula of law"},
}};

std::string_view insteadOf(std::string_view function) {
  for (const ForeignFunction& one : kForeignFunctions) {
    if (one.name == function) {
      return one.instead;
    }
  }
  return {};
}

struct Sensor {
  std::string_view name;
  dynamics::Input input;
  Dimension dimension;
  double low;
  double high;
};

constexpr std::array<Sensor, 9> kSensors{{
    {"light", dynamics::kLight, kPure, 0, 1},
    {"light_front", dynamics::kLightFront, kPure, 0, 1},
    {"light_back", dynamics::kLightBack, kPure, 0, 1},
    {"battery", dynamics::kBattery, kVoltage, 0, 65.535},
    {"time", dynamics::kTime, kTime, 0, kLargestNumber},
    {"phase_time", dynamics::kPhaseTime, kTime, 0, kLargestNumber},
    {"heading", dynamics::kHeading, kPure, -std::numbers::pi, std::numbers::pi},
    {"distance", dynamics::kDistance, kLength, 0, kLargestNumber},
    {"id", dynamics::kId, kPure, 0, kLargestNumber},
}};

const Function* functionNamed(std::string_view name) {
  const auto* found = std::find_if(kFunctions.begin(), kFunctions.end(),
                                   [&](const Function& f) { return f.name == name; });
  return found == kFunctions.end() ? nullptr : found;
}

CheckedExpression constantNumber(double value, const Dimension& dimension) {
  CheckedExpression result;
  result.dimension = dimension;
  result.constant = true;
  result.range = {value, value, true};
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
  return x.dimension == kPure ? "a number without unit" : "a number in " + unitText(x.dimension);
}

class Checker {
 public:
  Checker(std::string_view text, const Scope& scope, std::vector<RangeNote>& notes, Type wanted)
      : text_(text), scope_(scope), notes_(notes), phase_wanted_(wanted == Type::kPhase) {}

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

  [[nodiscard]] std::string quoted(const Expression& node) const {
    return "'" + std::string(text_.substr(node.offset, node.length)) + "'";
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
    for (const Sensor& sensor : kSensors) {
      if (sensor.name == node.name) {
        return readInput(sensor.input, sensor.dimension, bounds(sensor.low, sensor.high));
      }
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
    if (const Function* function = functionNamed(node.name)) {
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

  static CheckedExpression readInput(std::uint8_t input, const Dimension& dimension,
                                     const Interval& range) {
    CheckedExpression result;
    result.dimension = dimension;
    result.range = range;
    result.opcode = dynamics::kRead;
    result.operand = input;
    return result;
  }

  CheckedExpression checkUnary(const Expression& node) {
    CheckedExpression operand = check(node.operands[0]);
    if (node.name == "not") {
      requireType(operand, Type::kTruth, node.operands[0], "after 'not'");
      return combined(Type::kTruth, kPure, Interval{0, 1, false}, dynamics::kNot, {operand});
    }
    requireType(operand, Type::kNumber, node.operands[0], "after '-'");
    refuseEndless(operand, node.operands[0]);
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
      requireType(a, Type::kTruth, node.operands[0], where);
      requireType(b, Type::kTruth, node.operands[1], where);
      return combined(Type::kTruth, kPure, Interval{0, 1, false},
                      node.name == "and" ? dynamics::kAnd : dynamics::kOr, {a, b});
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const CheckedExpression& operand = i == 0 ? a : b;
      requireType(operand, Type::kNumber, node.operands[i], where);
      refuseEndless(operand, node.operands[i]);
    }
    if (node.name == "*") {
      return combined(Type::kNumber, product(a.dimension, b.dimension), product(a.range, b.range),
                      dynamics::kMultiply, {a, b});
    }
    if (node.name == "/") {
      return divide(node, a, b);
    }
    const Dimension common = commonDimension(node, 0, a, b);
    if (node.name == "+" || node.name == "-") {
      const bool plus = node.name == "+";
      return combined(Type::kNumber, common, sum(a.range, plus ? b.range : negative(b.range)),
                      plus ? dynamics::kAdd : dynamics::kSubtract, {a, b});
    }
    return combined(Type::kTruth, kPure, Interval{0, 1, false}, comparison(node.name), {a, b});
  }

  static Opcode comparison(const std::string& symbol) {
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
                        "division by zero: " + quoted(node.operands[1]) + " is 0");
    }
    if (b.range.contains(0)) {
      notes_.push_back({node.operands[1].offset,
                        quoted(node.operands[1]) +
                            " can be 0; a division by 0 gives the largest number and is counted"});
    }
    return combined(Type::kNumber, quotient(a.dimension, b.dimension), quotient(a.range, b.range),
                    dynamics::kDivide, {a, b});
  }

  /// The dimension of two numbers, which are the operand `first` of the node and the one after it.
  Dimension commonDimension(const Expression& node, std::size_t first, const CheckedExpression& a,
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

  CheckedExpression checkCall(const Expression& node) {
    const Function* function = functionNamed(node.name);
    if (function == nullptr) {
      const std::string_view instead = insteadOf(node.name);
      throw SyntaxError(
          node.offset, "unknown function '" + node.name + "'; there are " + names() +
                           (instead.empty() ? suggestion(scope_.suggest, node.name, functionNames())
                                            : "; write " + std::string(instead)));
    }
    if (node.operands.size() != function->operands) {
      throw SyntaxError(node.offset, "'" + node.name + "' has " +
                                         std::to_string(node.operands.size()) +
                                         " arguments, expected " + std::string(function->usage) +
                                         commaAdvice(text_.substr(node.offset, node.length)));
    }
    std::vector<CheckedExpression> x;
    const bool wanted = phase_wanted_;
    for (const Expression& operand : node.operands) {
      phase_wanted_ = wanted && !x.empty();  // the condition of `if` is no phase
      x.push_back(check(operand));
    }
    if (node.name == "if") {
      if (wanted) {
        requireType(x[1], Type::kPhase, node.operands[1], "to go to");
      }
      return select(node, x);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      requireType(x[i], Type::kNumber, node.operands[i], "in " + std::string(function->usage));
      refuseEndless(x[i], node.operands[i]);
    }
    if (node.name == "ir" || node.name == "sense") {
      return numberedInput(node, x[0]);
    }
    const bool draw = node.name == "uniform" || node.name == "normal" ||
                      node.name == "exponential" || node.name == "pareto" ||
                      node.name == "chance" || node.name == "choose";
    return draw ? checkDraw(node, x) : checkFunction(node, x);
  }

  static std::vector<std::string> functionNames() {
    std::vector<std::string> names;
    for (const Function& function : kFunctions) names.emplace_back(function.name);
    return names;
  }

  static std::string names() {
    std::string text;
    for (const std::string& name : functionNames()) text += (text.empty() ? "" : ", ") + name;
    return text;
  }

  CheckedExpression select(const Expression& node, std::vector<CheckedExpression>& x) {
    requireType(x[0], Type::kTruth, node.operands[0], "as the first argument of 'if'");
    requireType(x[2], x[1].type, node.operands[2], "like " + quoted(node.operands[1]));
    // Sensors and history may never let a branch be taken; a draw does.
    const Interval range =
        x[0].range.isAttained() ? join(x[1].range, x[2].range) : either(x[1].range, x[2].range);
    CheckedExpression result =
        combined(x[1].type, kPure, range, dynamics::kSelect, {x[0], x[1], x[2]});
    result.constant = false;
    result.phases = x[1].phases | x[2].phases;
    if (x[1].type == Type::kNumber) {
      result.dimension = commonDimension(node, 1, x[1], x[2]);
    }
    return result;
  }

  CheckedExpression numberedInput(const Expression& node, const CheckedExpression& index) {
    const bool infrared = node.name == "ir";
    const int count = infrared ? dynamics::kIrSensors : dynamics::kSenses;
    const double number = index.range.low;
    if (!index.constant || number != std::floor(number) || number < 0 || number >= count) {
      throw SyntaxError(node.operands[0].offset, "found " + quoted(node.operands[0]) +
                                                     ", expected a whole number from 0 to " +
                                                     std::to_string(count - 1));
    }
    const int first = infrared ? dynamics::kIr : dynamics::kSense;
    const auto input = static_cast<std::uint8_t>(first + static_cast<int>(number));
    return infrared ? readInput(input, kPure, bounds(0, 1))
                    : readInput(input, kPure, bounds(-kLargestNumber, kLargestNumber));
  }

  CheckedExpression checkFunction(const Expression& node, const std::vector<CheckedExpression>& x) {
    const std::string& name = node.name;
    if (name == "abs") {
      return combined(Type::kNumber, x[0].dimension, absolute(x[0].range), dynamics::kAbs, {x[0]});
    }
    if (name == "sign") {
      const auto sign = [](double value) { return value > 0 ? 1.0 : value < 0 ? -1.0 : 0.0; };
      return combined(Type::kNumber, kPure, mapped(x[0].range, sign), dynamics::kSign, {x[0]});
    }
    if (name == "sqrt") {
      return squareRootOf(node, x[0]);
    }
    if (name == "sin" || name == "cos") {
      requireDimension(x[0], kPure, "the angle " + quoted(node.operands[0]),
                       node.operands[0].offset);
      Interval range = bounds(-1, 1);
      if (x[0].constant) {
        const double value = name == "sin" ? std::sin(x[0].range.low) : std::cos(x[0].range.low);
        range = {value, value, true};
      }
      return combined(Type::kNumber, kPure, range, name == "sin" ? dynamics::kSin : dynamics::kCos,
                      {x[0]});
    }
    const Dimension common = commonDimension(node, 0, x[0], x[1]);
    if (name == "atan2") {
      Interval range = bounds(-std::numbers::pi, std::numbers::pi);
      if (x[0].constant && x[1].constant) {
        const double value = std::atan2(x[0].range.low, x[1].range.low);
        range = {value, value, true};
      }
      return combined(Type::kNumber, kPure, range, dynamics::kAtan2, {x[0], x[1]});
    }
    if (name == "clamp") {
      commonDimension(node, 1, x[1], x[2]);
      const CheckedExpression upper = combined(
          Type::kNumber, common, smaller(x[0].range, x[2].range), dynamics::kMin, {x[0], x[2]});
      return combined(Type::kNumber, common, larger(upper.range, x[1].range), dynamics::kMax,
                      {upper, x[1]});
    }
    const bool least = name == "min";
    return combined(Type::kNumber, common,
                    least ? smaller(x[0].range, x[1].range) : larger(x[0].range, x[1].range),
                    least ? dynamics::kMin : dynamics::kMax, {x[0], x[1]});
  }

  CheckedExpression squareRootOf(const Expression& node, const CheckedExpression& x) {
    const auto dimension = squareRoot(x.dimension);
    const Expression& operand = node.operands[0];
    if (!dimension) {
      throw SyntaxError(operand.offset, quoted(operand) + " is " + typeText(x) +
                                            ", expected a square such as cm^2");
    }
    if (x.range.high < 0) {
      throw SyntaxError(operand.offset, "square root of a negative number: " + quoted(operand));
    }
    if (x.range.low < 0) {
      notes_.push_back({operand.offset, quoted(operand) +
                                            " can be negative; its square root is then 0 and is "
                                            "counted"});
    }
    const auto root = [](double value) { return std::sqrt(std::max(0.0, value)); };
    return combined(Type::kNumber, *dimension, mapped(x.range, root), dynamics::kSqrt, {x});
  }

  CheckedExpression checkDraw(const Expression& node, const std::vector<CheckedExpression>& x) {
    const std::string& name = node.name;
    CheckedExpression result;
    if (name == "uniform") {
      const Dimension common = commonDimension(node, 0, x[0], x[1]);
      if (x[0].range.low > x[1].range.high) {
        throw SyntaxError(node.offset,
                          "the draw begins above its end: " + quoted(node.operands[0]) + " is " +
                              valueText(x[0]) + ", " + quoted(node.operands[1]) + " is " +
                              valueText(x[1]) + ", expected uniform(low, high)");
      }
      result = combined(Type::kNumber, common, join(x[0].range, x[1].range), dynamics::kUniform,
                        {x[0], x[1]});
    } else if (name == "normal") {
      const Dimension common = commonDimension(node, 0, x[0], x[1]);
      if (x[1].range.high < 0) {
        throw SyntaxError(node.operands[1].offset, "the deviation " + quoted(node.operands[1]) +
                                                       " is " + valueText(x[1]) +
                                                       ", expected 0 or more");
      }
      const double reach = kLargestNormal * x[1].range.magnitude();
      result = combined(Type::kNumber, common,
                        unbounded(sum(x[0].range, bounds(-reach, reach)), x[0].range),
                        dynamics::kNormal, {x[0], x[1]});
    } else if (name == "exponential") {
      requirePositive(x[0], node.operands[0], "the mean of an exponential draw");
      result = combined(Type::kNumber, x[0].dimension,
                        unbounded(bounds(0, kLongestExponential * x[0].range.high), x[0].range),
                        dynamics::kExponential, {x[0]});
    } else if (name == "pareto") {
      requirePositive(x[0], node.operands[0], "the minimum of a Pareto draw");
      requirePositive(x[1], node.operands[1], "the exponent of a Pareto draw");
      requireDimension(x[1], kPure, "the exponent " + quoted(node.operands[1]),
                       node.operands[1].offset);
      const double longest = x[1].range.low > 0
                                 ? x[0].range.high * std::exp(kLongestExponential / x[1].range.low)
                                 : kLargestNumber;
      result = combined(Type::kNumber, x[0].dimension,
                        unbounded(bounds(x[0].range.low, longest), x[0].range), dynamics::kPareto,
                        {x[0], x[1]});
    } else if (name == "chance") {
      result = chance(node, x[0]);
    } else {
      result = choose(node, x[0]);
    }
    result.constant = false;
    return result;
  }

  /// A draw without a bound that programs reach: it counts with the mean (Pareto: the minimum).
  static Interval unbounded(Interval range, const Interval& mean) {
    range.sure_low = std::clamp(mean.sure_low, range.low, range.high);
    range.sure_high = std::clamp(mean.sure_high, range.low, range.high);
    return range;
  }

  CheckedExpression choose(const Expression& node, const CheckedExpression& x) {
    const Expression& operand = node.operands[0];
    requireDimension(x, kPure, quoted(operand), operand.offset);
    if (x.range.high < 1 || (x.constant && x.range.low != std::floor(x.range.low))) {
      throw SyntaxError(operand.offset, "choose(n) found n = " + quoted(operand) +
                                            ", expected a whole number of 1 or more");
    }
    Interval range(0, std::floor(x.range.high) - 1);
    range.sure_high = std::max(0.0, std::floor(x.range.sure_high) - 1);
    return combined(Type::kNumber, kPure, range, dynamics::kChoose, {x});
  }

  CheckedExpression chance(const Expression& node, const CheckedExpression& x) {
    const Expression& operand = node.operands[0];
    requireDimension(x, kPure, "the probability " + quoted(operand), operand.offset);
    const bool outside = x.range.low < 0 || x.range.high > 1;
    if (outside && (x.constant || x.range.high < 0 || x.range.low > 1)) {
      throw SyntaxError(operand.offset, "the probability " + quoted(operand) + " is " +
                                            std::to_string(x.range.low) + ", expected 0 to 1");
    }
    if (outside) {
      notes_.push_back({operand.offset, "the probability " + quoted(operand) +
                                            " can lie outside 0 to 1, where it counts as 0 or 1"});
    }
    const bool both = x.constant && x.range.low > 0 && x.range.low < 1;
    return combined(Type::kTruth, kPure, Interval{0, 1, both}, dynamics::kChance, {x});
  }

  /// "-1 1/s"; the largest value of a number that is not constant.
  static std::string valueText(const CheckedExpression& x) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", x.range.high);
    return text.data() + (x.dimension == kPure ? "" : " " + unitText(x.dimension));
  }

  void requirePositive(const CheckedExpression& x, const Expression& node,
                       const std::string& what) {
    if (x.range.high <= 0) {
      throw SyntaxError(node.offset, what + " is " + quoted(node) + ", expected more than 0");
    }
    if (x.range.low <= 0) {
      notes_.push_back({node.offset, what + " " + quoted(node) +
                                         " can be 0 or less; the draw is then its limit and is "
                                         "counted"});
    }
  }

  void requireType(const CheckedExpression& x, Type type, const Expression& node,
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

  void refuseEndless(const CheckedExpression& x, const Expression& node) const {
    if (x.endless) {
      throw SyntaxError(node.offset, "'forever' can only stand alone, as a hold");
    }
  }

  /// A node with its operands; constant if all operands are.
  static CheckedExpression combined(Type type, const Dimension& dimension, const Interval& range,
                                    Opcode opcode, std::vector<CheckedExpression> children) {
    CheckedExpression result;
    result.type = type;
    result.dimension = dimension;
    result.range = range;
    result.opcode = opcode;
    result.constant = type == Type::kNumber && range.isPoint() &&
                      std::all_of(children.begin(), children.end(),
                                  [](const CheckedExpression& x) { return x.constant; });
    result.children = std::move(children);
    return result;
  }

  std::string_view text_;
  const Scope& scope_;
  std::vector<RangeNote>& notes_;
  bool phase_wanted_;  ///< The node shall be a phase.
};

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Names that the language gives a meaning.
std::vector<std::string> namesOfTheLanguage() {
  std::vector<std::string> names{"pi", "forever"};
  for (const Sensor& sensor : kSensors) names.emplace_back(sensor.name);
  for (const Function& function : kFunctions) names.emplace_back(function.name);
  return names;
}

}  // namespace

std::string Scope::knownNames(std::string_view unknown) const {
  const std::string_view instead = otherUnit(unknown);
  if (!instead.empty()) return ": write " + std::string(instead) + " for this unit";
  std::vector<std::string> names;
  for (const auto& [name, value] : parameters) names.push_back(name);
  for (const auto& [name, value] : states) names.push_back(name);
  for (const auto& [name, value] : phases) names.push_back(name);
  const std::string own = names.empty() ? "no names of its own" : listed(names);
  std::ranges::copy(namesOfTheLanguage(), std::back_inserter(names));
  return "; this program has " + own + ", and docs/programs.md lists those of the language" +
         suggestion(suggest, unknown, names);
}

std::string Scope::knownPhases(std::string_view unknown) const {
  std::vector<std::string> names;
  for (const auto& [name, value] : phases) names.push_back(name);
  return ", expected a phase: " + listed(names) + suggestion(suggest, unknown, names);
}

CheckedExpression checkExpression(std::string_view text, const Expression& expression,
                                  const Scope& scope, std::vector<RangeNote>& notes, Type wanted) {
  return Checker(text, scope, notes, wanted).check(expression);
}

void requireDimension(const CheckedExpression& number, const Dimension& dimension,
                      const std::string& what, std::size_t offset) {
  if (number.any_dimension || number.dimension == dimension) {
    return;
  }
  const std::string expected =
      dimension == kPure ? "a number without unit" : "a number in " + unitText(dimension);
  throw SyntaxError(offset, what + " is " + typeText(number) + ", expected " + expected);
}

bool isReserved(std::string_view name) {
  constexpr std::array<std::string_view, 5> kWords{"and", "or", "not", "pi", "forever"};
  return unitNamed(name).has_value() ||
         std::find(kWords.begin(), kWords.end(), name) != kWords.end() ||
         (functionNamed(name) != nullptr && name != kFreeFunction) ||
         std::any_of(kSensors.begin(), kSensors.end(),
                     [&](const Sensor& sensor) { return sensor.name == name; });
}

std::string inputName(std::uint8_t input) {
  const auto numbered = [&](const char* name, int first) {
    return name + ("(" + std::to_string(input - first) + ")");
  };
  if (input >= dynamics::kSense) return numbered("sense", dynamics::kSense);
  if (input >= dynamics::kIr && input < dynamics::kIr + dynamics::kIrSensors) {
    return numbered("ir", dynamics::kIr);
  }
  for (const Sensor& sensor : kSensors) {
    if (sensor.input == input) return std::string(sensor.name);
  }
  return "?";
}

}  // namespace lab::language
