#include "runner/command_line/print_line.hpp"

#include <gtest/gtest.h>

#include <string>

namespace lab::runner::print_line_test {
namespace {

/// `last_error` of a service is a text that any program on the bus can publish.
TEST(PrintLine, TextsOfOthersCannotControlTheTerminal) {
  testing::internal::CaptureStdout();
  printFaults({"analyzer: \x1b[2J\x1b]0;title\x07", "two\nlines"});
  printLine("web      \x1b[31m");
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "fault    analyzer: \\x1b[2J\\x1b]0;title\\x07\n"
            "fault    two\\x0alines\n"
            "web      \\x1b[31m\n");
}

}  // namespace
}  // namespace lab::runner::print_line_test
