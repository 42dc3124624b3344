#pragma once

#include <span>
#include <vector>

#include "robot/language/dimension.hpp"
#include "robot/language/formula.hpp"

namespace lab::language {

/// A node whose names, types and dimensions are right.
struct Formula::Node {
  enum Operation {
    kConstant,
    kLag,
    kSense,
    kNegate,
    kNot,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kLess,
    kLessOrEqual,
    kGreater,
    kGreaterOrEqual,
    kEqual,
    kUnequal,
    kAnd,
    kOr,
    kIf,
    kMin,
    kMax,
    kAbs,
    kSign,
    kClamp,
    kSqrt,
    kSin,
    kCos,
    kAtan2,
    kExp,
    kLog,
    kPow
  };

  Operation operation = kConstant;
  double value = 0;  ///< Of a constant; the number of a sense.
  std::vector<Node> operands;

  bool truth = false;          ///< A condition, not a number.
  bool any_dimension = false;  ///< The literal 0, which fits every dimension.
  Dimension dimension;
};

/// What a formula is evaluated with.
struct FormulaInputs {
  double tau = 0;
  std::span<const double> senses;  ///< By their numbers.
};

[[nodiscard]] double evaluate(const Formula::Node& node, const FormulaInputs& inputs);

}  // namespace lab::language
