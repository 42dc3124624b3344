#include "common/text/utf8.hpp"

#include <gtest/gtest.h>

#include <string>

namespace lab {
namespace {

std::string repaired(std::string text) {
  repairUtf8(text);
  return text;
}

TEST(Utf8, LeavesValidTextUnchanged) {
  // The first and the last character of each length, and the neighbours of the surrogates.
  for (const char* text :
       {"", "abp", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "\xCE\xB7 = 3 rad\xC2\xB2/s"}) {
    EXPECT_EQ(repaired(text), text);
  }
}

TEST(Utf8, ReplacesInvalidBytes) {
  EXPECT_EQ(repaired("a\xFFz"), "a\uFFFDz");
  EXPECT_EQ(repaired("a\x80"), "a\uFFFD") << "a continuation byte alone";
  EXPECT_EQ(repaired("\xC0\xAF"), "\uFFFD\uFFFD") << "an overlong slash";
  EXPECT_EQ(repaired("\xE0\x80\x80"), "\uFFFD\uFFFD\uFFFD") << "an overlong NUL";
  EXPECT_EQ(repaired("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD") << "a surrogate";
  EXPECT_EQ(repaired("\xF4\x90\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD") << "above U+10FFFF";
  EXPECT_EQ(repaired("caf\xE9 au lait"), "caf\uFFFD au lait") << "Latin-1";
  EXPECT_EQ(repaired("\xE2\x82"), "\uFFFD") << "a truncated character";
  EXPECT_EQ(repaired("\xF0\x9F\x98z"), "\uFFFDz");
}

TEST(Utf8, EndsThePrefixBetweenTwoCharacters) {
  EXPECT_EQ(utf8Prefix("abc", 3), "abc");
  EXPECT_EQ(utf8Prefix("abcd", 3), "abc");
  EXPECT_EQ(utf8Prefix("a\xC2\xB2", 2), "a");
  EXPECT_EQ(utf8Prefix("a\xC2\xB2z", 3), "a\xC2\xB2");
  EXPECT_EQ(utf8Prefix("\xF0\x9F\x98\x80", 3), "");
  EXPECT_EQ(utf8Prefix("x", 0), "");
  EXPECT_EQ(utf8Prefix(std::string(10, '\x80'), 8).size(), 5U) << "no character has so many bytes";
}

TEST(Utf8, GivesTheResultOfTheStandardsExample) {
  // Unicode 15, table 3-8.
  EXPECT_EQ(repaired("\x61\xF1\x80\x80\xE1\x80\xC2\x62\x80\x63\x80\xBF\x64"),
            "a\uFFFD\uFFFD\uFFFDb\uFFFDc\uFFFD\uFFFDd");
}

}  // namespace
}  // namespace lab
