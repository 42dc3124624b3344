#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/language/checked_expression.hpp"
#include "robot/language/compiled_program.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/expression_context.hpp"
#include "robot/language/program_text.hpp"
#include "robot/language/scope.hpp"

namespace lab::language {

/// Reads the texts of a program's keys as checked expressions, in the scope of the moment, and
/// keeps what is wrong.
class KeyReader {
 public:
  /// @param text whose phases the scope then knows
  /// @param suggest for messages about unknown names
  KeyReader(const ProgramText& text, Suggest suggest);

  /// The checked expression of a key; nothing after an error, which is then kept.
  std::optional<CheckedExpression> read(const std::string& key, const std::string& text,
                                        Type wanted = Type::kNumber);
  /// The same for a number of this dimension.
  std::optional<CheckedExpression> readNumber(const std::string& key, const std::string& text,
                                              const Dimension& dimension, bool may_be_endless);
  /// The same for a phase.
  std::optional<CheckedExpression> readPhase(const std::string& key, const std::string& text);

  void error(const std::string& key, std::size_t offset, const std::string& message) {
    errors_.push_back({key, offset, message});
  }

  [[nodiscard]] const std::vector<Problem>& errors() const { return errors_; }
  /// An error says what to write where the unit is wrong.
  [[nodiscard]] bool hasAdvised() const { return advised_; }
  /// What can go wrong when the program runs: by key, of the last check.
  [[nodiscard]] const std::map<std::string, std::vector<RangeNote>>& notes() const {
    return notes_;
  }

  Scope scope;

 private:
  std::vector<std::string> phase_names_;  ///< In the order of the text.
  std::vector<Problem> errors_;
  bool advised_ = false;
  std::map<std::string, Expression> syntax_;  ///< By key, parsed once.
  std::map<std::string, std::vector<RangeNote>> notes_;
};

}  // namespace lab::language
