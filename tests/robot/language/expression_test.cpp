#include "robot/language/expression.hpp"

#include <gtest/gtest.h>

#include <string>

namespace lab::language {
namespace {

/// With brackets around every operation, to show what binds to what.
std::string bracketed(const Expression& node) {
  if (node.kind == Expression::kNumber) {
    return std::to_string(static_cast<int>(node.value));
  }
  if (node.kind == Expression::kName) {
    return node.name;
  }
  std::string text = node.kind == Expression::kCall ? node.name + "(" : "(";
  for (std::size_t i = 0; i < node.operands.size(); ++i) {
    if (node.kind == Expression::kUnary) {
      text += node.name + " ";
    }
    if (i > 0) {
      text += node.kind == Expression::kBinary ? " " + node.name + " " : ", ";
    }
    text += bracketed(node.operands[i]);
  }
  return text + ")";
}

std::string parsed(const std::string& text) { return bracketed(parseExpression(text)); }

TEST(Expression, BindsAsInMathematics) {
  EXPECT_EQ(parsed("a + b * c"), "(a + (b * c))");
  EXPECT_EQ(parsed("a - b - c"), "((a - b) - c)");
  EXPECT_EQ(parsed("-a * b"), "((- a) * b)");
  EXPECT_EQ(parsed("(a + b) * c"), "((a + b) * c)");
  EXPECT_EQ(parsed("a < b and not c or d"), "(((a < b) and (not c)) or d)");
  EXPECT_EQ(parsed("min(a, b + 1)"), "min(a, (b + 1))");
}

TEST(Expression, AUnitBelongsToItsNumber) {
  EXPECT_EQ(parsed("5 cm/s"), "((5 * cm) / s)");
  EXPECT_EQ(parsed("2 / 5 cm"), "(2 / (5 * cm))");
  EXPECT_EQ(parsed("1/s"), "(1 / s)");
  EXPECT_EQ(parsed("3 1/s"), "((3 * 1) / s)");
  EXPECT_EQ(parsed("3 cm^2/s"), "((3 * (cm * cm)) / s)");
  EXPECT_EQ(parsed("3 cm/s^2"), "((3 * cm) / (s * s))");
}

TEST(Expression, SaysWhatItCoversInTheText) {
  const Expression sum = parseExpression(" a + (b * 2) ");
  EXPECT_EQ(sum.offset, 1U);
  EXPECT_EQ(sum.length, 11U);
  EXPECT_EQ(sum.operands[1].offset, 5U);
  EXPECT_EQ(sum.operands[1].length, 7U);
}

struct WrongText {
  const char* text;
  std::size_t offset;
  const char* message;
};

class WrongSyntax : public testing::TestWithParam<WrongText> {};

TEST_P(WrongSyntax, IsSaidWithItsPosition) {
  const WrongText& wrong = GetParam();
  try {
    static_cast<void>(parseExpression(wrong.text));
    FAIL() << "accepted " << wrong.text;
  } catch (const SyntaxError& error) {
    EXPECT_EQ(error.offset(), wrong.offset) << error.what();
    EXPECT_NE(std::string(error.what()).find(wrong.message), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongSyntax,
    testing::Values(WrongText{"", 0, "found the end of the text, expected a number"},
                    WrongText{"a +", 3, "found the end of the text"},
                    WrongText{"a b", 2, "found 'b', expected an operator"},
                    WrongText{"(a", 2, "expected ')' for the '(' at character 1"},
                    WrongText{"f(a", 3, "expected ')' for the '(' at character 2"},
                    WrongText{"a = b", 2, "equality is written '=='"},
                    WrongText{"a^2", 1, "only units have powers"},
                    WrongText{"a && b", 2, "logic is written 'and'"},
                    WrongText{"a < b < c", 6, "write 'a < b and b < c'"},
                    WrongText{"1e999", 0, "too large"},
                    WrongText{"a $ b", 2, "no expression contains"},
                    WrongText{"and a", 0, "found 'and'"}, WrongText{"a, b", 1, "found ','"}));

TEST(Expression, DeepNestingIsRefused) {
  const std::string deep = std::string(100000, '(') + "a" + std::string(100000, ')');
  EXPECT_THROW(static_cast<void>(parseExpression(deep)), SyntaxError);
  EXPECT_THROW(static_cast<void>(parseExpression(std::string(100000, '-') + "a")), SyntaxError);
}

TEST(Expression, LongChainsAreRefused) {
  for (const char* more : {"+a", "-a", "*a", "/a", " and a", " or a"}) {
    std::string chain = "a";
    for (int i = 0; i < kMostOperators; ++i) chain += more;
    EXPECT_NO_THROW(static_cast<void>(parseExpression(chain))) << more;
    EXPECT_THROW(static_cast<void>(parseExpression(chain + more)), SyntaxError) << more;
    // It would overflow the stack of what walks through the tree.
    for (int i = 0; i < 100'000; ++i) chain += more;
    EXPECT_THROW(static_cast<void>(parseExpression(chain)), SyntaxError) << more;
  }
}

}  // namespace
}  // namespace lab::language
