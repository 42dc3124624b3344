#include "common/text/printable.hpp"

#include <gtest/gtest.h>

namespace lab::printable_test {
namespace {

TEST(Printable, LeavesTextAsItIs) {
  EXPECT_EQ(printable("robot 3: 12 \xC2\xB5m \xE2\x86\x92 caf\xC3\xA9 \\x1b"),
            "robot 3: 12 \xC2\xB5m \xE2\x86\x92 caf\xC3\xA9 \\x1b");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, ShowsControlCharacters) {
  EXPECT_EQ(printable("\x1b[2J\x07 a\rb\nc\td\x7f"), "\\x1b[2J\\x07 a\\x0db\\x0ac\\x09d\\x7f");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\x9b31m")
      << "CSI in one character";
}

TEST(Printable, ShowsWhatTurnsTheText) {
  EXPECT_EQ(printable("a\xE2\x80\xAE"
                      "b\xE2\x81\xA6"),
            "a\\u202eb\\u2066");
}

TEST(Printable, ReplacesInvalidBytes) {
  EXPECT_EQ(printable("a\xFF"
                      "b\x9B\xE2\x80"),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD\xEF\xBF\xBD");
}

TEST(Printable, KeepsLinesWhereTheyAreWanted) {
  EXPECT_EQ(printableLines("a\n\tb\r\x1b"), "a\n\tb\\x0d\\x1b");
}

}  // namespace
}  // namespace lab::printable_test
