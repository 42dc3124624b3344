#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robot/language/compiler.hpp"
#include "robot/language/dimension.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// A formula of a law: an expression of a program's parameters and, if it is a curve, the lag
/// `tau`. It is evaluated on the host in double precision and may use exp, log and pow besides the
/// functions of programs, but nothing that the robot draws or measures (docs/theory.md).
class Formula {
 public:
  /// @param text the expression
  /// @param parameters of the program
  /// @param dimension that the value must have
  /// @param curve whether `tau` is known
  /// @param suggest for messages
  /// @throws SyntaxError where it is wrong
  Formula(std::string_view text, const std::vector<Parameter>& parameters,
          const Dimension& dimension, bool curve, Suggest suggest = nullptr);

  /// The value in the units of programs (cm, s, rad).
  [[nodiscard]] double operator()(double tau = 0) const;

  struct Node;

 private:
  std::shared_ptr<const Node> root_;
};

/// The dimension of a formula of a law: "msd", "angular_msd", "D", "D_r".
[[nodiscard]] Dimension formulaDimension(const std::string& law_key);

/// Whether it depends on the lag.
[[nodiscard]] bool isCurve(const std::string& law_key);

}  // namespace lab::language
