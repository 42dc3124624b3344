#include "robot/language/expression.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "robot/language/dimension.hpp"
#include "robot/language/lexer.hpp"

namespace lab::language {
namespace {

constexpr std::string_view kNoPowers =
    "only units have powers (cm^2): write a product such as x*x, in a formula of law pow(x, n)";
constexpr double kHighestPower = 9;

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

  Expression binary(const std::string& symbol, Expression left, Expression right) {
    if (++operators_ > kMostOperators) {
      throw SyntaxError(left.offset, "the expression has more than " +
                                         std::to_string(kMostOperators) +
                                         " operators; use a state variable for a part of it");
    }
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
  int operators_ = 0;
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
