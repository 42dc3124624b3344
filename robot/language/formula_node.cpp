#include "robot/language/formula_node.hpp"

#include <algorithm>
#include <cmath>

namespace lab::language {

double evaluate(const Formula::Node& node, const FormulaInputs& inputs) {
  using Node = Formula::Node;
  const auto at = [&](std::size_t i) { return evaluate(node.operands[i], inputs); };
  switch (node.operation) {
    case Node::kConstant:
      return node.value;
    case Node::kLag:
      return inputs.tau;
    case Node::kSense:
      return inputs.senses[static_cast<std::size_t>(node.value)];
    case Node::kNegate:
      return -at(0);
    case Node::kNot:
      return at(0) == 0 ? 1 : 0;
    case Node::kAdd:
      return at(0) + at(1);
    case Node::kSubtract:
      return at(0) - at(1);
    case Node::kMultiply:
      return at(0) * at(1);
    case Node::kDivide:
      return at(0) / at(1);
    case Node::kLess:
      return at(0) < at(1) ? 1 : 0;
    case Node::kLessOrEqual:
      return at(0) <= at(1) ? 1 : 0;
    case Node::kGreater:
      return at(0) > at(1) ? 1 : 0;
    case Node::kGreaterOrEqual:
      return at(0) >= at(1) ? 1 : 0;
    case Node::kEqual:
      return at(0) == at(1) ? 1 : 0;
    case Node::kUnequal:
      return at(0) != at(1) ? 1 : 0;
    case Node::kAnd:
      return at(0) != 0 && at(1) != 0 ? 1 : 0;
    case Node::kOr:
      return at(0) != 0 || at(1) != 0 ? 1 : 0;
    case Node::kIf:
      return at(0) != 0 ? at(1) : at(2);
    case Node::kMin:
      return std::min(at(0), at(1));
    case Node::kMax:
      return std::max(at(0), at(1));
    case Node::kAbs:
      return std::abs(at(0));
    case Node::kSign: {
      const double x = at(0);
      return x > 0 ? 1 : x < 0 ? -1 : 0;
    }
    case Node::kClamp:
      return std::max(at(1), std::min(at(0), at(2)));
    case Node::kSqrt:
      return std::sqrt(at(0));
    case Node::kSin:
      return std::sin(at(0));
    case Node::kCos:
      return std::cos(at(0));
    case Node::kAtan2:
      return std::atan2(at(0), at(1));
    case Node::kExp:
      return std::exp(at(0));
    case Node::kLog:
      return std::log(at(0));
    case Node::kPow:
      return std::pow(at(0), at(1));
  }
  return 0;
}

}  // namespace lab::language
