#include "robot/language/expression.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "robot/language/dimension.hpp"
#include "robot/language/spelled_name.hpp"

namespace lab::language {
namespace {

enum class TokenKind { kEnd, kNumber, kName, kSymbol };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string text;
  double value = 0;
  std::size_t offset = 0;
  std::size_t end = 0;
};

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// What other languages and texts write, and what to write here.
struct Foreign {
  std::string_view symbol;
  std::string_view instead;
};

constexpr std::string_view kNoPowers =
    "only units have powers (cm^2): write a product such as x*x, in a formula of law pow(x, n)";
constexpr std::string_view kNoSigns = "powers of units are written cm^2, others as a product x*x";
constexpr double kHighestPower = 9;

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

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token next() {
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

 private:
  void read(Token& token) {
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

  void readNumber(Token& token) {
    token.kind = TokenKind::kNumber;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), token.value);
    if (error != std::errc() || !std::isfinite(token.value)) {
      throw SyntaxError(at_, "this number is too large or too small");
    }
    token.text.assign(begin, end);
    at_ += token.text.size();
  }

  void readSymbol(Token& token) {
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

  [[nodiscard]] std::string describeUnknown(char c) const {
    const std::string_view rest = text_.substr(at_);
    for (const Foreign& foreign : kForeign) {
      if (rest.starts_with(foreign.symbol)) {
        return "found '" + std::string(foreign.symbol) + "'; " + std::string(foreign.instead);
      }
    }
    const std::string_view greek = greekLetterIn(rest.substr(0, 2));
    if (!greek.empty()) {
      return "found '" + std::string(greek) + "'; names are written in ASCII" +
             spelledAdvice(greek);
    }
    const bool printable = c > ' ' && c < 127;
    return "found " + (printable ? std::string("'") + c + "'" : std::string("a character")) +
           " that no expression contains";
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text), lexer_(text) { advance(); }

  Expression parseAll() {
    Expression result = parseOr();
    if (token_.kind != TokenKind::kEnd) {
      const bool is_name = token_.kind == TokenKind::kName;
      throw unexpected(!is_name ? "an operator or the end"
                       : isWord("if")
                           ? "an operator or the end; a choice is written if(condition, a, b)"
                           : "an operator or the end; products are written with '*', "
                             "units as cm/s");
    }
    return result;
  }

 private:
  /// Keeps nested texts from using up the stack.
  class Depth {
   public:
    Depth(int& depth, std::size_t offset) : depth_(depth) {
      if (++depth_ > kDeepestExpression) {
        throw SyntaxError(offset, "the expression is nested deeper than " +
                                      std::to_string(kDeepestExpression) +
                                      " levels; use a state variable for a part of it");
      }
    }
    ~Depth() { --depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;

   private:
    int& depth_;
  };

  void advance() {
    last_end_ = token_.end;
    previous_ = std::exchange(token_, lexer_.next());
  }

  /// A comma that was meant as a decimal point: "0,5".
  [[nodiscard]] bool isDecimalComma() const {
    return isSymbol(",") && previous_.kind == TokenKind::kNumber &&
           previous_.end == token_.offset && token_.end < text_.size() &&
           isDigit(text_[token_.end]);
  }

  /// What was found instead of `expected`.
  [[nodiscard]] SyntaxError unexpected(const std::string& expected) const {
    if (isDecimalComma()) {
      std::size_t end = token_.end;
      while (end < text_.size() && isDigit(text_[end])) {
        ++end;
      }
      const std::string digits(text_.substr(token_.end, end - token_.end));
      return {previous_.offset, "found '" + previous_.text + "," + digits +
                                    "'; decimals are written with a point: '" + previous_.text +
                                    "." + digits + "'"};
    }
    return {token_.offset, "found " + found() + ", expected " + expected};
  }

  [[nodiscard]] bool isSymbol(std::string_view text) const {
    return token_.kind == TokenKind::kSymbol && token_.text == text;
  }
  [[nodiscard]] bool isWord(std::string_view text) const {
    return token_.kind == TokenKind::kName && token_.text == text;
  }
  [[nodiscard]] std::string found() const {
    return token_.kind == TokenKind::kEnd ? "the end of the text" : "'" + token_.text + "'";
  }

  Expression finish(Expression node) const {
    node.length = last_end_ - node.offset;
    return node;
  }

  Expression binary(const std::string& symbol, Expression left, Expression right) const {
    Expression node;
    node.kind = Expression::kBinary;
    node.name = symbol;
    node.offset = left.offset;
    node.operands.push_back(std::move(left));
    node.operands.push_back(std::move(right));
    return finish(std::move(node));
  }

  Expression parseOr() {
    const Depth depth(depth_, token_.offset);
    Expression left = parseAnd();
    while (isWord("or")) {
      advance();
      left = binary("or", std::move(left), parseAnd());
    }
    return left;
  }

  Expression parseAnd() {
    Expression left = parseNot();
    while (isWord("and")) {
      advance();
      left = binary("and", std::move(left), parseNot());
    }
    return left;
  }

  Expression parseNot() {
    if (!isWord("not")) {
      return parseComparison();
    }
    return parsePrefix(&Parser::parseNot);
  }

  Expression parsePrefix(Expression (Parser::*operand)()) {
    const Depth depth(depth_, token_.offset);
    Expression node;
    node.kind = Expression::kUnary;
    node.name = token_.text;
    node.offset = token_.offset;
    advance();
    node.operands.push_back((this->*operand)());
    return finish(std::move(node));
  }

  Expression parseComparison() {
    Expression left = parseSum();
    if (!isComparison()) {
      return left;
    }
    const std::string symbol = token_.text;
    advance();
    Expression node = binary(symbol, std::move(left), parseSum());
    if (isComparison()) {
      throw SyntaxError(
          token_.offset,
          "found a second comparison; write 'a < b and b < c' instead of 'a < b < c'");
    }
    return node;
  }

  [[nodiscard]] bool isComparison() const {
    constexpr std::array<std::string_view, 6> kSymbols{"<", "<=", ">", ">=", "==", "!="};
    for (const std::string_view symbol : kSymbols) {
      if (isSymbol(symbol)) {
        return true;
      }
    }
    return false;
  }

  Expression parseSum() {
    Expression left = parseProduct();
    while (isSymbol("+") || isSymbol("-")) {
      const std::string symbol = token_.text;
      advance();
      left = binary(symbol, std::move(left), parseProduct());
    }
    return left;
  }

  Expression parseProduct() {
    Expression left = parseUnary();
    while (isSymbol("*") || isSymbol("/")) {
      const std::string symbol = token_.text;
      advance();
      left = binary(symbol, std::move(left), parseUnary());
    }
    return left;
  }

  Expression parseUnary() {
    if (isSymbol("-")) {
      return parsePrefix(&Parser::parseUnary);
    }
    return parsePrimary();
  }

  Expression parsePrimary() { return power(parseUnpowered()); }

  Expression parseUnpowered() {
    if (token_.kind == TokenKind::kNumber) {
      return parseNumber();
    }
    if (token_.kind == TokenKind::kName) {
      return parseName();
    }
    if (!isSymbol("(")) {
      if (isSymbol("*") && previous_.text == "*" && previous_.end == token_.offset) {
        throw SyntaxError(previous_.offset, "found '**'; " + std::string(kNoPowers));
      }
      throw unexpected("a number, a name or '('");
    }
    const std::size_t offset = token_.offset;
    advance();
    Expression inner = parseOr();
    expectClosing(offset);
    inner.offset = offset;
    return finish(std::move(inner));
  }

  /// A number, and the unit that may follow it: "5 cm" is 5 * cm, and "3 1/s" is 3 * 1 / s.
  Expression parseNumber() {
    Expression number;
    number.value = token_.value;
    number.offset = token_.offset;
    advance();
    number = finish(std::move(number));
    const bool named = token_.kind == TokenKind::kName && unitNamed(token_.text);
    const bool inverse = token_.kind == TokenKind::kNumber && token_.text == "1";
    if (token_.kind == TokenKind::kName && !named && !isWord("and") && !isWord("or")) {
      throw SyntaxError(token_.offset,
                        "found '" + token_.text + "' after a number" + unitAdvice(token_.text));
    }
    if (!named && !inverse) {
      return number;
    }
    Expression unit;
    unit.kind = named ? Expression::kName : Expression::kNumber;
    unit.name = named ? token_.text : "";
    unit.value = 1;
    unit.offset = token_.offset;
    advance();
    return binary("*", std::move(number), power(finish(std::move(unit))));
  }

  /// A unit, and the power that may follow it: "cm^2" is cm * cm.
  Expression power(Expression unit) {
    if (!isSymbol("^")) {
      return unit;
    }
    if (unit.kind != Expression::kName || !unitNamed(unit.name)) {
      throw SyntaxError(token_.offset, "found '^'; " + std::string(kNoPowers));
    }
    advance();
    const double exponent = token_.value;
    if (token_.kind != TokenKind::kNumber || exponent < 1 || exponent > kHighestPower ||
        exponent != std::floor(exponent)) {
      throw unexpected("a whole number from 1 to 9 as the power of '" + unit.name +
                       "'; a negative power is a division: 1/" + unit.name);
    }
    advance();
    Expression product = unit;
    for (int i = 1; i < static_cast<int>(exponent); ++i) {
      product = binary("*", std::move(product), unit);
    }
    return product;
  }

  Expression parseName() {
    Expression node;
    node.kind = Expression::kName;
    node.name = token_.text;
    node.offset = token_.offset;
    if (node.name == "and" || node.name == "or") {
      throw unexpected("a number, a name or '('");
    }
    advance();
    if (!isSymbol("(")) {
      return finish(std::move(node));
    }
    node.kind = Expression::kCall;
    const std::size_t opening = token_.offset;
    advance();
    if (!isSymbol(")")) {
      node.operands.push_back(parseOr());
      while (isSymbol(",")) {
        advance();
        node.operands.push_back(parseOr());
      }
    }
    expectClosing(opening);
    return finish(std::move(node));
  }

  void expectClosing(std::size_t opening) {
    if (!isSymbol(")")) {
      throw unexpected("')' for the '(' at character " + std::to_string(opening + 1));
    }
    advance();
  }

  std::string_view text_;
  Lexer lexer_;
  Token token_;
  Token previous_;
  std::size_t last_end_ = 0;
  int depth_ = 0;
};

}  // namespace

Expression parseExpression(std::string_view text) { return Parser(text).parseAll(); }

std::string commaAdvice(std::string_view text) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == ',' && isDigit(text[i - 1]) && isDigit(text[i + 1])) {
      return "; decimals are written with a point, not a comma";
    }
  }
  return {};
}

}  // namespace lab::language
