/// The words and symbols of an expression.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lab::language {

enum class TokenKind { kEnd, kNumber, kName, kSymbol };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string text;
  double value = 0;
  std::size_t offset = 0;
  std::size_t end = 0;
};

[[nodiscard]] constexpr bool isDigit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
 public:
  /// @param text must outlive the lexer
  explicit Lexer(std::string_view text) : text_(text) {}

  /// The next token; kEnd at the end of the text. Throws SyntaxError.
  [[nodiscard]] Token next();

 private:
  void read(Token& token);
  void readNumber(Token& token);
  void readSymbol(Token& token);
  [[nodiscard]] std::string describeUnknown(char c) const;

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace lab::language
