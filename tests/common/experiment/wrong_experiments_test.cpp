// Each file of wrong_experiments/ begins with its expected problems, one per line:
// "# expect 12: key: found ..., allowed ...". No other problem may be reported.
#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/law_knowledge.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/text_file.hpp"

namespace lab {
namespace {

constexpr std::string_view kExpect = "# expect ";

std::vector<std::string> expectedProblems(const std::filesystem::path& file) {
  std::vector<std::string> problems;
  std::istringstream lines(support::readFile(file));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kExpect)) {
      problems.push_back(file.string() + ":" + line.substr(kExpect.size()));
    }
  }
  return problems;
}

class WrongExperiment : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(WrongExperiment, IsRefusedWithFileLineKeyAndAdvice) {
  const std::vector<std::string> expected = expectedProblems(GetParam());
  ASSERT_FALSE(expected.empty());
  try {
    static_cast<void>(loadExperiment(GetParam(), {}, analysis::lawKnowledge()));
    FAIL() << "was accepted";
  } catch (const ExperimentError& error) {
    EXPECT_THAT(error.problems(), ::testing::ElementsAreArray(expected));
  }
}

// Limits of what is to be played: a log that was recorded before they came stays readable.
TEST(RecordedExperiment, MayExceedLimitsOfRuns) {
  int files = 0;
  for (const std::filesystem::path& file : tomlFiles("tests/common/experiment/wrong_experiments")) {
    const std::string name = file.stem().string();
    if (!(name.starts_with("light_") && name.ends_with("_too_short")) &&
        name != "light_too_many_steps" && name != "observable_with_too_many_robots" &&
        name != "senses_too_fast_for_the_line") {
      continue;
    }
    ++files;
    EXPECT_NO_THROW(static_cast<void>(loadRecordedExperiment(file))) << file;
  }
  EXPECT_EQ(files, 6);
}

INSTANTIATE_TEST_SUITE_P(
    Files, WrongExperiment,
    ::testing::ValuesIn(tomlFiles("tests/common/experiment/wrong_experiments")),
    [](const auto& parameter) { return parameter.param.stem().string(); });

}  // namespace
}  // namespace lab
