#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robot/language/compiled_program.hpp"
#include "robot/language/dimension.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/suggestion.hpp"

namespace lab::language {

/// A formula of a law: an expression of a program's parameters and, if it is a curve, the lag
/// `tau`. Or one of a virtual sense: an expression of other senses. It is evaluated on the host in
/// double precision and may use exp, log and pow besides the functions of programs, but nothing
/// that the robot draws or measures (docs/theory.md, docs/programs.md).
class Formula {
 public:
  /// @param text an expression of sense(0) to sense(7) without unit
  /// @param known bit i: sense(i) may be used
  /// @param suggest for messages
  /// @throws SyntaxError where it is wrong
  [[nodiscard]] static Formula ofSenses(std::string_view text, unsigned known,
                                        Suggest suggest = nullptr);

  /// @param text the expression
  /// @param parameters of the program
  /// @param dimension that the value must have
  /// @param curve whether `tau` is known
  /// @param suggest for messages
  /// @throws SyntaxError where it is wrong
  Formula(std::string_view text, const std::vector<Parameter>& parameters,
          const Dimension& dimension, bool curve, Suggest suggest = nullptr);

  /// The value in the units of programs (cm, s, rad).
  /// @param senses those that the formula uses, by their numbers
  [[nodiscard]] double operator()(double tau = 0, std::span<const double> senses = {}) const;

  struct Node;

 private:
  Formula() = default;

  std::shared_ptr<const Node> root_;
};

/// Whether a key of ProgramText::law is a formula; the others belong to a closed form.
[[nodiscard]] bool isFormula(const std::string& law_key);

/// The dimension of a formula of a law: "msd", "angular_msd", "D", "D_r".
[[nodiscard]] Dimension formulaDimension(const std::string& law_key);

/// Whether it depends on the lag.
[[nodiscard]] bool isCurve(const std::string& law_key);

}  // namespace lab::language
