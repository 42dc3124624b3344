#include "runner/commands/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::command_line_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

int runLab(std::vector<std::string> words) {
  words.insert(words.begin(), "lab");
  std::vector<char*> raw;
  for (std::string& word : words) raw.push_back(word.data());
  raw.push_back(nullptr);
  const int count = static_cast<int>(words.size());
  if (words.size() < 2 || words[1] != "calibrate") return runCommandLine(count, raw.data());
  // This command is the program lab-calibrate.
  return runCommands(count, raw.data(),
                     [](CLI::App& app, Chosen& chosen) { addCalibrate(app, chosen, {}); });
}

TEST(CommandLine, NamesAnUnknownCommandAndListsTheKnownOnes) {
  EXPECT_THAT(
      [] { runLab({"frobnicate"}); },
      ThrowsMessage<UserError>(AllOf(StartsWith("found \"frobnicate\", expected one of run, "),
                                     HasSubstr("doctor"), Not(HasSubstr("host-agent")))));
  EXPECT_THAT([] { runLab({}); },
              ThrowsMessage<UserError>(StartsWith("found no command, expected one of run, ")));
  EXPECT_THAT(
      [] {
        runLab({"calibrate", "frobnicate"});
      },
      ThrowsMessage<UserError>(
          AllOf(StartsWith("calibrate: found \"frobnicate\", expected one of "),
                HasSubstr("motors"), HasSubstr("lab calibrate --help"))));
}

TEST(CommandLine, RefusesAnInvalidSeed) {
  for (const char* seed : {"-5", "1.5", "x", "9223372036854775808"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(runLab({"run", "abp", "--seed", seed, "--virtual-time"}), kBadInput);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                HasSubstr("--seed: found " + std::string(seed) + ", allowed whole numbers from 0"));
  }
}

}  // namespace
}  // namespace lab::runner::command_line_test
