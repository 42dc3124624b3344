#include "robot/language/formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/formula_node.hpp"

namespace lab::language {
namespace {

using Node = Formula::Node;

struct Function {
  std::string_view name;
  Node::Operation operation;
  std::size_t operands;
  std::string_view usage;
};

constexpr std::array<Function, 13> kFunctions{{
    {"if", Node::kIf, 3, "if(condition, then, otherwise)"},
    {"min", Node::kMin, 2, "min(a, b)"},
    {"max", Node::kMax, 2, "max(a, b)"},
    {"abs", Node::kAbs, 1, "abs(x)"},
    {"sign", Node::kSign, 1, "sign(x)"},
    {"clamp", Node::kClamp, 3, "clamp(x, low, high)"},
    {"sqrt", Node::kSqrt, 1, "sqrt(x)"},
    {"sin", Node::kSin, 1, "sin(angle)"},
    {"cos", Node::kCos, 1, "cos(angle)"},
    {"atan2", Node::kAtan2, 2, "atan2(y, x)"},
    {"exp", Node::kExp, 1, "exp(x)"},
    {"log", Node::kLog, 1, "log(x)"},
    {"pow", Node::kPow, 2, "pow(x, exponent)"},
}};

struct Operator {
  std::string_view name;
  Node::Operation operation;
};

constexpr std::array<Operator, 12> kOperators{{{"+", Node::kAdd},
                                               {"-", Node::kSubtract},
                                               {"*", Node::kMultiply},
                                               {"/", Node::kDivide},
                                               {"<", Node::kLess},
                                               {"<=", Node::kLessOrEqual},
                                               {">", Node::kGreater},
                                               {">=", Node::kGreaterOrEqual},
                                               {"==", Node::kEqual},
                                               {"!=", Node::kUnequal},
                                               {"and", Node::kAnd},
                                               {"or", Node::kOr}}};

std::string describe(const Node& node) {
  if (node.truth) return "a condition";
  return node.dimension == kPure ? "a number without unit"
                                 : "a number in " + unitText(node.dimension);
}

class Checker {
 public:
  Checker(std::string_view text, const std::vector<Parameter>& parameters, bool curve,
          std::optional<unsigned> senses, Suggest suggest)
      : text_(text), parameters_(parameters), curve_(curve), senses_(senses), suggest_(suggest) {}

  Node check(const Expression& expression) const {
    switch (expression.kind) {
      case Expression::kNumber: {
        Node node = constant(expression.value, kPure);
        node.any_dimension = expression.value == 0;
        return node;
      }
      case Expression::kName:
        return checkName(expression);
      case Expression::kUnary:
        return checkUnary(expression);
      case Expression::kBinary:
        return checkBinary(expression);
      case Expression::kCall:
        return checkCall(expression);
    }
    throw SyntaxError(expression.offset, "not an expression");
  }

 private:
  [[nodiscard]] std::string quoted(const Expression& expression) const {
    return "'" + std::string(text_.substr(expression.offset, expression.length)) + "'";
  }

  static Node constant(double value, const Dimension& dimension) {
    Node node;
    node.value = value;
    node.dimension = dimension;
    return node;
  }

  Node checkName(const Expression& expression) const {
    const std::string& name = expression.name;
    for (const Parameter& parameter : parameters_) {
      if (parameter.name == name) return constant(parameter.value, parameter.dimension);
    }
    if (name == "tau" && curve_) {
      Node lag;
      lag.operation = Node::kLag;
      lag.dimension = kTime;
      return lag;
    }
    if (name == "pi") return constant(std::numbers::pi, kPure);
    if (const auto unit = unitNamed(name)) return constant(unit->size, unit->dimension);
    const std::string_view instead = otherUnit(name);
    if (!instead.empty()) {
      throw SyntaxError(expression.offset, "unknown name '" + name + "': write " +
                                               std::string(instead) + " for this unit");
    }
    std::string known = curve_ ? "tau (the lag)" : senses_ ? "sense(0) to sense(7)" : "";
    std::vector<std::string> names{"pi"};
    if (curve_) names.emplace_back("tau");
    for (const Parameter& parameter : parameters_) {
      known += (known.empty() ? "" : ", ") + parameter.name;
      names.push_back(parameter.name);
    }
    throw SyntaxError(expression.offset, "unknown name '" + name + "'; a formula has " +
                                             (known.empty() ? "no names here" : known) +
                                             ", pi and the units" +
                                             suggestion(suggest_, name, names));
  }

  Node checkUnary(const Expression& expression) const {
    Node node;
    node.operands.push_back(check(expression.operands[0]));
    const Node& operand = node.operands[0];
    node.truth = expression.name == "not";
    require(operand, node.truth, expression.operands[0], "after '" + expression.name + "'");
    node.operation = node.truth ? Node::kNot : Node::kNegate;
    node.dimension = operand.dimension;
    node.any_dimension = operand.any_dimension;
    return node;
  }

  Node checkBinary(const Expression& expression) const {
    const Operator* found =
        std::ranges::find(kOperators, std::string_view(expression.name), &Operator::name);
    Node node;
    node.operation = found->operation;
    const bool logic = node.operation == Node::kAnd || node.operation == Node::kOr;
    for (const Expression& operand : expression.operands) {
      node.operands.push_back(check(operand));
      require(node.operands.back(), logic, operand, "beside '" + expression.name + "'");
    }
    const Node& a = node.operands[0];
    const Node& b = node.operands[1];
    if (logic) {
      node.truth = true;
    } else if (node.operation == Node::kMultiply) {
      node.dimension = product(a.dimension, b.dimension);
    } else if (node.operation == Node::kDivide) {
      node.dimension = quotient(a.dimension, b.dimension);
    } else {
      const Dimension both = common(expression, node, 0);
      node.truth = node.operation != Node::kAdd && node.operation != Node::kSubtract;
      if (!node.truth) node.dimension = both;
      node.any_dimension = !node.truth && a.any_dimension && b.any_dimension;
    }
    return node;
  }

  /// sense(i), where it is known.
  [[nodiscard]] Node checkSense(const Expression& expression) const {
    const bool whole = expression.operands.size() == 1 &&
                       expression.operands[0].kind == Expression::kNumber &&
                       expression.operands[0].value == std::floor(expression.operands[0].value) &&
                       expression.operands[0].value < dynamics::kSenses;
    if (!whole) {
      throw SyntaxError(expression.offset,
                        "found " + quoted(expression) + ", expected sense(0) to sense(7)");
    }
    const double index = expression.operands[0].value;
    if ((*senses_ >> static_cast<unsigned>(index) & 1U) == 0) {
      throw SyntaxError(expression.offset, quoted(expression) +
                                               " is defined by no other entry, or by an "
                                               "expression; expected one that is neither");
    }
    Node node = constant(index, kPure);
    node.operation = Node::kSense;
    return node;
  }

  Node checkCall(const Expression& expression) const {
    if (senses_ && expression.name == "sense") return checkSense(expression);
    const Function* function =
        std::ranges::find(kFunctions, std::string_view(expression.name), &Function::name);
    if (function == kFunctions.end()) {
      std::string list;
      std::vector<std::string> names;
      for (const Function& one : kFunctions) {
        list += (list.empty() ? "" : ", ") + std::string(one.name);
        names.emplace_back(one.name);
      }
      throw SyntaxError(expression.offset,
                        "unknown function '" + expression.name + "'; a formula has " + list +
                            (senses_ ? ", and sense(0) to sense(7)" : ", and no draws or sensors") +
                            suggestion(suggest_, expression.name, names));
    }
    if (expression.operands.size() != function->operands) {
      throw SyntaxError(expression.offset,
                        "'" + expression.name + "' has " +
                            std::to_string(expression.operands.size()) + " arguments, expected " +
                            std::string(function->usage) +
                            commaAdvice(text_.substr(expression.offset, expression.length)));
    }
    Node node;
    node.operation = function->operation;
    for (std::size_t i = 0; i < expression.operands.size(); ++i) {
      const bool condition = node.operation == Node::kIf && i == 0;
      node.operands.push_back(check(expression.operands[i]));
      require(node.operands.back(), condition, expression.operands[i],
              "in " + std::string(function->usage));
    }
    setDimension(expression, node);
    return node;
  }

  void setDimension(const Expression& expression, Node& node) const {
    const auto pure = [&](std::size_t i) {
      const Node& operand = node.operands[i];
      if (operand.any_dimension || operand.dimension == kPure) return;
      throw SyntaxError(expression.operands[i].offset, quoted(expression.operands[i]) + " is " +
                                                           describe(operand) +
                                                           ", expected a number without unit");
    };
    switch (node.operation) {
      case Node::kIf:
        node.dimension = common(expression, node, 1);
        return;
      case Node::kClamp:
        node.dimension = common(expression, node, 0);
        common(expression, node, 1);
        return;
      case Node::kMin:
      case Node::kMax:
        node.dimension = common(expression, node, 0);
        return;
      case Node::kAtan2:
        common(expression, node, 0);
        return;
      case Node::kAbs:
        node.dimension = node.operands[0].dimension;
        return;
      case Node::kSqrt: {
        const auto root = squareRoot(node.operands[0].dimension);
        if (!root) {
          throw SyntaxError(expression.operands[0].offset, quoted(expression.operands[0]) + " is " +
                                                               describe(node.operands[0]) +
                                                               ", expected a square such as cm^2");
        }
        node.dimension = *root;
        return;
      }
      case Node::kSign:
        return;
      default:
        for (std::size_t i = 0; i < node.operands.size(); ++i) pure(i);
    }
  }

  void require(const Node& node, bool truth, const Expression& expression,
               const std::string& where) const {
    if (node.truth == truth) return;
    throw SyntaxError(expression.offset, quoted(expression) + " is " + describe(node) +
                                             ", expected " +
                                             (truth ? "a condition " : "a number ") + where);
  }

  /// The dimension of the operands `first` and `first` + 1.
  Dimension common(const Expression& expression, const Node& node, std::size_t first) const {
    const Node& a = node.operands[first];
    const Node& b = node.operands[first + 1];
    if (a.any_dimension) return b.dimension;
    if (!b.any_dimension && !(a.dimension == b.dimension)) {
      const Expression& right = expression.operands[first + 1];
      throw SyntaxError(right.offset, quoted(right) + " is " + describe(b) + ", expected " +
                                          describe(a) + " like " +
                                          quoted(expression.operands[first]));
    }
    return a.dimension;
  }

  std::string_view text_;
  const std::vector<Parameter>& parameters_;
  bool curve_;
  std::optional<unsigned> senses_;  ///< Bit i: sense(i) is known. Empty: the formula of a law.
  Suggest suggest_;
};

}  // namespace

Formula::Formula(std::string_view text, const std::vector<Parameter>& parameters,
                 const Dimension& dimension, bool curve, Suggest suggest) {
  const Expression expression = parseExpression(text);
  auto root =
      std::make_shared<Node>(Checker(text, parameters, curve, {}, suggest).check(expression));
  if (root->truth || !(root->any_dimension || root->dimension == dimension)) {
    throw SyntaxError(
        0, "the formula is " + describe(*root) + ", expected a number " +
               (dimension == kPure ? "without unit (rad^2)" : "in " + unitText(dimension)));
  }
  root_ = std::move(root);
}

double Formula::operator()(double tau, std::span<const double> senses) const {
  return evaluate(*root_, {tau, senses});
}

Formula Formula::ofSenses(std::string_view text, unsigned known, Suggest suggest) {
  const Expression expression = parseExpression(text);
  auto root = std::make_shared<Node>(Checker(text, {}, false, known, suggest).check(expression));
  if (root->truth || !(root->any_dimension || root->dimension == kPure)) {
    throw SyntaxError(0, "the expression is " + describe(*root) +
                             ", expected a number without unit (senses have none)");
  }
  Formula formula;
  formula.root_ = std::move(root);
  return formula;
}

bool isFormula(const std::string& law_key) {
  return law_key == "msd" || law_key == "angular_msd" || law_key == "D" || law_key == "D_r";
}

Dimension formulaDimension(const std::string& law_key) {
  if (law_key == "msd") return product(kLength, kLength);
  if (law_key == "D") return quotient(product(kLength, kLength), kTime);
  if (law_key == "D_r") return kRate;
  return kPure;
}

bool isCurve(const std::string& law_key) { return law_key == "msd" || law_key == "angular_msd"; }

}  // namespace lab::language
