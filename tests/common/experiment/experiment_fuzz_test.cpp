#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <string>

#include "tests/support/experiment_samples.hpp"
#include "tests/support/text_file.hpp"

namespace lab {
namespace {

/// Loads a damaged file.
/// @return 1 if it is still a valid experiment, 0 if it is refused with a reason; fails otherwise
int outcome(const std::string& text) {
  try {
    const Experiment experiment = parseExperiment(text, "damaged.toml");
    EXPECT_EQ(parseExperiment(writeExperiment(experiment), "written"), experiment) << text;
    return 1;
  } catch (const ExperimentError& error) {
    EXPECT_FALSE(error.problems().empty());
    return 0;
  }
}

class DamagedExperiment : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(DamagedExperiment, TruncatedIsRefusedOrValid) {
  const std::string text = support::readFile(GetParam());
  int accepted = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    accepted += outcome(text.substr(0, length));
  }
  EXPECT_LT(accepted, static_cast<int>(text.size()));
  EXPECT_EQ(outcome(text), 1);
}

TEST_P(DamagedExperiment, WithAReplacedByteIsRefusedOrValid) {
  constexpr std::array<char, 6> kBytes = {'\0', '"', '[', '9', '\xff', '\n'};
  const std::string text = support::readFile(GetParam());
  int accepted = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = kBytes[i % kBytes.size()];
    accepted += outcome(damaged);
    damaged[i] = static_cast<char>(text[i] ^ (1 << (i % 8)));
    accepted += outcome(damaged);
  }
  EXPECT_GT(accepted, 0);
}

TEST_P(DamagedExperiment, WithAMissingLineIsRefusedOrValid) {
  const std::string text = support::readFile(GetParam());
  int accepted = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin) + 1;
    std::string damaged = text;
    accepted += outcome(damaged.erase(begin, end - begin));
    begin = end;
  }
  EXPECT_GT(accepted, 0);
}

INSTANTIATE_TEST_SUITE_P(Shipped, DamagedExperiment, ::testing::ValuesIn(tomlFiles("experiments")),
                         [](const auto& parameter) { return parameter.param.stem().string(); });

}  // namespace
}  // namespace lab
