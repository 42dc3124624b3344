#include "common/command_line/parse_arguments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace lab::parse_arguments_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// The command line of a service, and what it prints.
class ParseArguments : public testing::Test {
 protected:
  ParseArguments() {
    app_.add_option("--experiment,--config", experiment_, "Experiment file")->required();
    app_.add_option("--ports", ports_, "Folder")->check([](const std::string& folder) {
      return folder == "here" ? "" : "found " + folder + ", expected here";
    });
    app_.add_option("--offset", offset_);
    app_.add_flag("--list", list_);
  }

  /// What is printed on stdout and stderr.
  std::string printed(const std::vector<const char*>& arguments) {
    std::vector<const char*> words{"bridge"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    code_ = parseArguments(app_, static_cast<int>(words.size()), words.data());
    return testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  }

  CLI::App app_{"Robots on serial lines", "bridge"};
  std::string experiment_;
  std::string ports_;
  std::int64_t offset_ = 0;
  bool list_ = false;
  std::optional<int> code_;
};

TEST_F(ParseArguments, GoesOnAfterACorrectCommandLine) {
  EXPECT_EQ(printed({"--config", "abp.toml", "--ports", "here"}), "");

  EXPECT_EQ(code_, std::nullopt);
  EXPECT_EQ(experiment_, "abp.toml");
}

TEST_F(ParseArguments, NamesAnUnknownOptionBeforeWhatIsMissing) {
  EXPECT_EQ(printed({"--lst"}),
            "bridge: --lst: no such option of `bridge`; did you mean --list?\n");
  EXPECT_EQ(code_, 2);
  EXPECT_EQ(printed({"--list", "--frobnicate"}),
            "bridge: --frobnicate: no such option of `bridge`; bridge --help lists them\n");
  EXPECT_EQ(printed({"--port", "there", "--ports", "there"}),
            "bridge: --port: no such option of `bridge`; did you mean --ports?\n");
}

TEST_F(ParseArguments, SaysInOneLineWhatIsMissing) {
  EXPECT_EQ(printed({}), "bridge: --experiment is required; bridge --help explains it\n");
  EXPECT_EQ(code_, 2);
  EXPECT_EQ(printed({"more"}),
            "bridge: --experiment is required; found \"more\", but `bridge` takes options only; "
            "bridge --help lists its options\n");
}

TEST_F(ParseArguments, NamesOptionsAsTheyWereTyped) {
  EXPECT_EQ(printed({"--config"}),
            "bridge: --config: found no value, expected TEXT; bridge --help explains it\n");
  EXPECT_EQ(printed({"--config", "a", "--experiment=b"}),
            "bridge: --config/--experiment: found 2 values, a and b; keep one\n");
}

TEST_F(ParseArguments, TakesNoOptionForAValue) {
  EXPECT_EQ(printed({"--config", "--list"}),
            "bridge: --config: found no value, expected TEXT; --config=--list if such a value is "
            "meant\n");
  EXPECT_EQ(code_, 2);
  EXPECT_THAT(printed({"--config=", "--list"}), StartsWith("bridge: --config: found no value, "));
  EXPECT_THAT(printed({"--config", "a", "--ports", "--offset=3"}),
              StartsWith("bridge: --ports: found no value, expected TEXT; --ports=--offset=3 if "));
  EXPECT_THAT(printed({"--config", "a", "--offset", "--list", "--lists"}),
              StartsWith("bridge: --lists: no such option"));
  EXPECT_THAT(printed({"--config", "--list", "a"}), StartsWith("bridge: --config: found no value"));
  EXPECT_THAT(printed({"--config", "a", "--offset", "--list"}),
              StartsWith("bridge: --offset: found no value, expected INT"));

  EXPECT_EQ(printed({"--experiment=--list"}), "");
  EXPECT_EQ(code_, std::nullopt);
  EXPECT_EQ(experiment_, "--list");
  EXPECT_FALSE(list_);
  EXPECT_EQ(printed({"--config", "-", "--offset", "-5", "--list"}), "");
  EXPECT_EQ(offset_, -5);
  EXPECT_TRUE(list_);
}

TEST_F(ParseArguments, SaysWhatItFoundInPlaceOfANumber) {
  EXPECT_EQ(printed({"--config", "a", "--offset", "x"}),
            "bridge: --offset: found x, expected a whole number; bridge --help explains it\n");
  EXPECT_EQ(code_, 2);
  double length = 0;
  app_.add_option("--length,--size", length);
  EXPECT_EQ(printed({"--config", "a", "--size", "long"}),
            "bridge: --size: found long, expected a number; bridge --help explains it\n");
  EXPECT_EQ(printed({"--config", "a", "--list=maybe"}),
            "bridge: --list: found maybe, expected true or false; bridge --help explains it\n");
}

TEST_F(ParseArguments, PrintsWordsOfTheUserWithoutControlCharacters) {
  EXPECT_THAT(printed({"--config", "a", "\x1b[2J"}), StartsWith("bridge: found \"\\x1b[2J\", but"));
}

TEST_F(ParseArguments, PrintsHelpWhateverElseIsTyped) {
  for (const std::vector<const char*>& arguments :
       std::vector<std::vector<const char*>>{{"--help"},
                                             {"--help", "--frobnicate"},
                                             {"more", "-h"},
                                             {"--ports", "there", "--help"},
                                             {"--help", "--ports"},
                                             // CLI11 takes --help for the folder and for the file.
                                             {"--config", "a", "--ports", "--help"},
                                             {"--config", "--help"}}) {
    EXPECT_THAT(printed(arguments), StartsWith("Robots on serial lines\n"))
        << testing::PrintToString(arguments);
    EXPECT_EQ(code_, 0);
  }
}

TEST_F(ParseArguments, PassesOnWhatChecksThrow) {
  app_.add_option_function<std::string>(
      "--sum", [](const std::string&) { throw std::runtime_error("no such sum"); });

  EXPECT_THROW(printed({"--config", "a", "--sum", "3"}), std::runtime_error);
  testing::internal::GetCapturedStdout();
  testing::internal::GetCapturedStderr();
  EXPECT_THAT(printed({"--config", "a", "--sum", "3", "--sun"}),
              HasSubstr("--sun: no such option"));
  EXPECT_THAT(printed({"--config", "a", "--sum", "3", "--help"}), HasSubstr("Usage: bridge"));
}

}  // namespace
}  // namespace lab::parse_arguments_test
