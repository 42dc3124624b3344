#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lab::language {

/// One node of an expression as it was written (docs/programs.md, grammar).
struct Expression {
  enum Kind {
    kNumber,  ///< `value`
    kName,    ///< `name`: a parameter, state variable, sensor, unit or phase
    kCall,    ///< `name` is the function
    kUnary,   ///< `name` is "-" or "not"
    kBinary   ///< `name` is the operator
  };

  Kind kind = kNumber;
  double value = 0;
  std::string name;
  std::vector<Expression> operands;
  std::size_t offset = 0;  ///< Of its first character in the text.
  std::size_t length = 0;  ///< Characters of the text that it covers.
};

/// What is wrong in a text, and where.
class SyntaxError : public std::runtime_error {
 public:
  SyntaxError(std::size_t offset, const std::string& message)
      : std::runtime_error(message), offset_(offset) {}

  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  std::size_t offset_;
};

/// Expressions may be nested so deep.
constexpr int kDeepestExpression = 40;
/// Operators of an expression. A chain such as a + b + c is a tree as deep as it is long.
constexpr int kMostOperators = 500;

/// Parses a text. Throws SyntaxError.
[[nodiscard]] Expression parseExpression(std::string_view text);

/// The end of a message about too many arguments, if the text has a comma between digits.
[[nodiscard]] std::string commaAdvice(std::string_view text);

}  // namespace lab::language
