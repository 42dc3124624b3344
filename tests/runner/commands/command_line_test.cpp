#include "runner/commands/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::command_line_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

int typed(std::vector<std::string> words) {
  words.insert(words.begin(), "lab");
  std::vector<char*> raw;
  for (std::string& word : words) raw.push_back(word.data());
  return runCommandLine(static_cast<int>(raw.size()), raw.data());
}

TEST(CommandLine, NamesAnUnknownCommandAndListsTheKnownOnes) {
  EXPECT_THAT(
      [] { typed({"frobnicate"}); },
      ThrowsMessage<UserError>(AllOf(StartsWith("found \"frobnicate\", expected one of run, "),
                                     HasSubstr("doctor"), Not(HasSubstr("host-agent")))));
  EXPECT_THAT([] { typed({}); },
              ThrowsMessage<UserError>(StartsWith("found no command, expected one of run, ")));
  EXPECT_THAT(
      [] {
        typed({"calibrate", "frobnicate"});
      },
      ThrowsMessage<UserError>(
          AllOf(StartsWith("calibrate: found \"frobnicate\", expected one of "),
                HasSubstr("motors"), HasSubstr("lab calibrate --help"))));
}

TEST(CommandLine, RefusesAnInvalidSeed) {
  for (const char* seed : {"-5", "1.5", "x", "9223372036854775808"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(typed({"run", "abp", "--seed", seed, "--virtual-time"}), kBadInput);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                HasSubstr("--seed: found " + std::string(seed) + ", allowed whole numbers from 0"));
  }
}

}  // namespace
}  // namespace lab::runner::command_line_test
