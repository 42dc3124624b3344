#include "runner/commands/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <exception>
#include <string>
#include <vector>

#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::command_line_test {
namespace {

using testing::AllOf;
using testing::EndsWith;
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

std::string errorOf(const std::vector<std::string>& words) {
  try {
    static_cast<void>(runLab(words));
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CommandLine, RefusesAnInvalidSeed) {
  for (const char* seed : {"-5", "1.5", "x", "9223372036854775808"}) {
    EXPECT_THAT(
        errorOf({"run", "abp", "--seed", seed, "--virtual-time"}),
        StartsWith("--seed: found " + std::string(seed) + ", allowed whole numbers from 0"));
  }
}

TEST(CommandLine, NamesAnUnknownOptionAsTypedAndWhatIsMeant) {
  EXPECT_EQ(errorOf({"run", "abp", "--run", "there"}),
            "--run: no such option of `lab run`; did you mean --runs?");
  EXPECT_EQ(errorOf({"run", "abp", "--virtual"}),
            "--virtual: no such option of `lab run`; did you mean --virtual-time?");
  EXPECT_EQ(errorOf({"run", "--sed=2", "abp"}),
            "--sed: no such option of `lab run`; did you mean --seed?");
  // Its value is taken for FILE, and there is no such experiment: the option is the mistake.
  EXPECT_EQ(errorOf({"run", "--outt", "there", "abp"}),
            "--outt: no such option of `lab run`; did you mean --out?");
  EXPECT_EQ(errorOf({"web", "--frobnicate"}),
            "--frobnicate: no such option of `lab web`; lab web --help lists them");
  EXPECT_EQ(errorOf({"calibrate", "motors", "abp", "--robots", "2"}),
            "--robots: no such option of `lab calibrate motors`; did you mean --robot?");
}

TEST(CommandLine, SuggestsNoOptionThatHasOnlyItsDashesInCommon) {
  EXPECT_EQ(errorOf({"check", "abp", "--out", "there"}),
            "--out: no such option of `lab check`; lab check --help lists them");
  EXPECT_EQ(errorOf({"spy", "--foo"}),
            "--foo: no such option of `lab spy`; lab spy --help lists them");
  EXPECT_EQ(errorOf({"spy", "-x"}), "-x: no such option of `lab spy`; lab spy --help lists them");
  // Similar without the dashes.
  EXPECT_EQ(errorOf({"check", "abp", "-set", "seed=3"}),
            "-set: no such option of `lab check`; did you mean --set?");
  EXPECT_EQ(errorOf({"light", "--foor", "3"}),
            "--foor: no such option of `lab light`; did you mean --for?");
}

TEST(CommandLine, SaysWhichKeyAnUnknownOptionStandsFor) {
  EXPECT_EQ(errorOf({"run", "abp", "--duration", "30"}),
            "--duration: no such option of `lab run`; did you mean --set duration_s=30?");
  EXPECT_EQ(errorOf({"check", "abp", "--fps=25"}),
            "--fps: no such option of `lab check`; did you mean --set camera.fps=25?");
  EXPECT_EQ(errorOf({"run", "abp", "--duration"}),
            "--duration: no such option of `lab run`; did you mean --set duration_s=...?");
  // A key that is written as in the file goes before options that look like it.
  EXPECT_EQ(errorOf({"check", "abp", "--seed", "3"}),
            "--seed: no such option of `lab check`; did you mean --set seed=3?");
  // Its --set takes other keys.
  EXPECT_EQ(errorOf({"web", "--duration", "30"}),
            "--duration: no such option of `lab web`; lab web --help lists them");
}

TEST(CommandLine, SaysInOneLineWhatIsMissing) {
  EXPECT_EQ(errorOf({"run"}), "FILE is required; lab run --help explains it");
}

TEST(CommandLine, NamesAWordThatNothingTakes) {
  EXPECT_EQ(errorOf({"run", "abp", "cr", "more"}),
            "found \"cr\", but `lab run` takes nothing after FILE; lab run --help lists its "
            "options");
  EXPECT_EQ(errorOf({"run", "abp", "duration_s=30"}),
            "found \"duration_s=30\", but `lab run` takes nothing after FILE; did you mean --set "
            "duration_s=30?");
  EXPECT_EQ(errorOf({"stop", "clear"}),
            "found \"clear\", but `lab stop` takes options only; did you mean --clear?");
}

TEST(CommandLine, RefusesTwoValuesForOneKey) {
  EXPECT_EQ(errorOf({"run", "abp", "--seed", "2", "--set", "seed=3"}),
            "--seed 2 and --set seed=3: two values for one key; keep one");
  EXPECT_EQ(errorOf({"check", "abp", "--set", "duration_s=5", "--set", "duration_s = 6"}),
            "--set duration_s=5 and --set duration_s=6: two values for one key; keep one");
  EXPECT_EQ(
      errorOf({"programs-of-run", "abp", "--seed", "2", "--set", "seed=2", "--set", "seed = 2"}),
      "accepted");
}

TEST(CommandLine, RefusesTwoValuesOfOneOption) {
  EXPECT_EQ(errorOf({"run", "abp", "--seed", "2", "--seed", "3"}),
            "--seed: found 2 values, 2 and 3; keep one");
  EXPECT_EQ(errorOf({"run", "abp", "--runs", "a", "--out", "b"}),
            "--runs/--out: found 2 values, a and b; keep one");
  EXPECT_EQ(errorOf({"run", "abp", "--out=a", "--out", "b"}),
            "--out: found 2 values, a and b; keep one");
}

TEST(CommandLine, NamesAnOptionAsItWasTyped) {
  EXPECT_EQ(errorOf({"run", "abp", "--out"}),
            "--out: found no value, expected TEXT; lab run --help explains it");
  EXPECT_EQ(errorOf({"run", "abp", "--runs"}),
            "--runs: found no value, expected TEXT; lab run --help explains it");
  EXPECT_THAT(errorOf({"run", "abp", "--out", "/dev/null"}),
              StartsWith("--out: found no folder at /dev/null, expected one or a new name"));
}

TEST(CommandLine, TakesNoOptionForAValue) {
  // It would be a run in real time, in a folder of that name.
  EXPECT_EQ(errorOf({"run", "abp", "--out", "--virtual-time", "--set", "duration_s=1"}),
            "--out: found no value, expected TEXT; --out=--virtual-time if such a value is meant");
  // "there" is then FILE.
  EXPECT_THAT(errorOf({"run", "--set", "--runs", "there", "abp"}),
              StartsWith("--set: found no value, expected KEY=VALUE; --set=--runs if "));
  EXPECT_THAT(errorOf({"web", "--runs", "--version"}),
              StartsWith("--runs: found no value, expected TEXT"))
      << "an option of `lab`";
  EXPECT_EQ(errorOf({"programs-of-run", "abp", "--out=--virtual-time"}), "accepted");
}

TEST(CommandLine, NamesAWordThatNothingTakesBesideAnotherError) {
  EXPECT_EQ(errorOf({"run", "abp", "cr", "--out"}),
            "--out: found no value, expected TEXT; found \"cr\", but `lab run` takes nothing after "
            "FILE; lab run --help lists its options");
  EXPECT_EQ(errorOf({"run", "abp", "cr", "--out", "a", "--runs", "b"}),
            "--out/--runs: found 2 values, a and b; keep one; found \"cr\", but `lab run` takes "
            "nothing after FILE; lab run --help lists its options");
}

std::string helpOf(const std::vector<std::string>& words) {
  testing::internal::CaptureStdout();
  int code = kFailed;
  std::string error;
  try {
    code = runLab(words);
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  const std::string printed = testing::internal::GetCapturedStdout();
  return code == kDone ? printed : "no help: " + error;
}

TEST(CommandLine, PrintsHelpWhateverElseIsTyped) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"check", "--help"},
                                             {"check", "--help", "no_such_experiment"},
                                             {"check", "no_such_experiment", "-h"},
                                             {"check", "abp", "--help", "--frobnicate"},
                                             {"check", "abp", "--set", "--help"},
                                             {"check", "--help", "abp", "--set"},
                                             {"--help", "check", "no_such_experiment"}}) {
    EXPECT_THAT(helpOf(words), StartsWith("Check an experiment file and describe the run\n"))
        << testing::PrintToString(words);
  }
  EXPECT_THAT(helpOf({"run", "abp", "--seed", "x", "--help"}), StartsWith("Run an experiment"));
  // CLI11 takes --help for the folder, and there would be a run.
  EXPECT_THAT(helpOf({"run", "abp", "--virtual-time", "--runs", "--help"}),
              StartsWith("Run an experiment"));
  EXPECT_THAT(helpOf({"calibrate", "frobnicate", "--help"}), HasSubstr("\nSubcommands:\n"));
}

TEST(CommandLine, SuggestsCommandsAndExperiments) {
  EXPECT_THAT(errorOf({"replayy", "log"}), EndsWith("; did you mean replay?"));
  EXPECT_THAT(errorOf({"check", "abpp"}), EndsWith("; did you mean abp?"));
}

TEST(CommandLine, TakesTheFolderOfRunsByBothItsNames) {
  for (const char* command : {"programs-of-run", "run", "web"}) {
    for (const char* name : {"--runs", "--out"}) {
      // An error after the folder: the folder itself was accepted.
      EXPECT_THAT(errorOf({command, name, "there", "--frobnicate"}), StartsWith("--frobnicate: "))
          << command << " " << name;
    }
  }
}

TEST(CommandLine, RefusesADeviceAsTheFolderOfRuns) {
  EXPECT_THAT(errorOf({"run", "abp", "--runs", "/dev/null"}),
              StartsWith("--runs: found no folder at /dev/null, expected one or a new name"));
}

}  // namespace
}  // namespace lab::runner::command_line_test
