#include "robot/language/lexer.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "robot/language/expression.hpp"
#include "robot/language/spelled_name.hpp"

namespace lab::language {
namespace {

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// What other languages and texts write, and what to write here.
struct Foreign {
  std::string_view symbol;
  std::string_view instead;
};

constexpr std::string_view kNoSigns = "powers of units are written cm^2, others as a product x*x";

constexpr std::array<Foreign, 17> kForeign{
    {{"=", "equality is written '=='; state variables get their values in 'set'"},
     {"\u00b2", kNoSigns},
     {"\u00b3", kNoSigns},
     {"&", "logic is written 'and', 'or', 'not'"},
     {"|", "logic is written 'and', 'or', 'not', a magnitude abs(x)"},
     {"!", "logic is written 'and', 'or', 'not'"},
     {"?", "a choice is written if(condition, a, b)"},
     {":", "a choice is written if(condition, a, b)"},
     {"%", "a share is written '5 percent'; there is no remainder"},
     {"\u00b0", "degrees are written 'deg'"},
     {"\u00b5", "micrometres are written 'um', microseconds '0.001 ms'"},
     {"\u03bc", "micrometres are written 'um', microseconds '0.001 ms'"},
     {"\u00b7", "a product is written '*'"},
     {"\u00d7", "a product is written '*'"},
     {"\u2212", "minus is written '-'"},
     {"\u2013", "minus is written '-'"},
     {"\u03c0", "write 'pi'"}}};

}  // namespace

Token Lexer::next() {
  while (at_ < text_.size() && isSpace(text_[at_])) {
    ++at_;
  }
  Token token;
  token.offset = at_;
  if (at_ < text_.size()) {
    read(token);
  }
  token.end = at_;
  return token;
}

void Lexer::read(Token& token) {
  const char c = text_[at_];
  if (isDigit(c) || (c == '.' && at_ + 1 < text_.size() && isDigit(text_[at_ + 1]))) {
    readNumber(token);
  } else if (isLetter(c)) {
    token.kind = TokenKind::kName;
    while (at_ < text_.size() && (isLetter(text_[at_]) || isDigit(text_[at_]))) {
      token.text += text_[at_++];
    }
  } else {
    readSymbol(token);
  }
}

void Lexer::readNumber(Token& token) {
  token.kind = TokenKind::kNumber;
  const char* const begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), token.value);
  if (error != std::errc() || !std::isfinite(token.value)) {
    throw SyntaxError(at_, "this number is too large or too small");
  }
  token.text.assign(begin, end);
  at_ += token.text.size();
}

void Lexer::readSymbol(Token& token) {
  token.kind = TokenKind::kSymbol;
  constexpr std::array<std::string_view, 4> kPairs{"<=", ">=", "==", "!="};
  for (const std::string_view pair : kPairs) {
    if (text_.substr(at_, 2) == pair) {
      token.text = pair;
      at_ += 2;
      return;
    }
  }
  const char c = text_[at_];
  if (std::string_view("+-*/<>(),^").find(c) == std::string_view::npos) {
    throw SyntaxError(at_, describeUnknown(c));
  }
  token.text = c;
  ++at_;
}

std::string Lexer::describeUnknown(char c) const {
  const std::string_view rest = text_.substr(at_);
  for (const Foreign& foreign : kForeign) {
    if (rest.starts_with(foreign.symbol)) {
      return "found '" + std::string(foreign.symbol) + "'; " + std::string(foreign.instead);
    }
  }
  const std::string_view greek = greekLetterIn(rest.substr(0, 2));
  if (!greek.empty()) {
    return "found '" + std::string(greek) + "'; names are written in ASCII" + spelledAdvice(greek);
  }
  const bool printable = c > ' ' && c < 127;
  return "found " + (printable ? std::string("'") + c + "'" : std::string("a character")) +
         " that no expression contains";
}

}  // namespace lab::language
