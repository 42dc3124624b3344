#include "runner/program/program_command.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/run_command.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::program_command_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kProgram =
    R"toml(law = {name = "rtp", gamma = "tau_t", v = "v", tau_t = "tau_t"}
parameters = {v = "5 cm/s", tau_t = "0.5 s", share = "0.3"}
[phases.run]
forward = "v"
hold = "exponential(tau_t)"
next = "tumble"
[phases.tumble]
turn = "uniform(-pi, pi)/tau_t"
hold = "tau_t"
next = "run"
)toml";

std::vector<std::string> problemsOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const ExperimentError& error) {
    return error.problems();
  }
  return {};
}

TEST(ProgramCommand, RefusesAWrongLaw) {
  const TemporaryFolder folder;
  const fs::path file = folder / "mine.toml";
  support::writeFile(file, kProgram);

  EXPECT_THAT(problemsOf([&] { static_cast<void>(loadProgram(file.string())); }),
              ElementsAre(HasSubstr("mine.toml:1:31: law.gamma: found a number in s, expected a "
                                    "number in 1/s for gamma of the law \"rtp\"")));
}

// Before anything starts: the programs that a run needs are asked for first.
TEST(ProgramCommand, AWrongLawStopsCheckAndRunToo) {
  const TemporaryFolder folder;
  support::writeFile(folder / "mine.toml", kProgram);
  RunOptions options;
  options.file = folder / "x.toml";
  support::writeFile(options.file,
                     std::string(kSmall) + "[programs.mine]\nmodel = \"mine.toml\"\n");

  const auto one = ElementsAre(HasSubstr("mine.toml:1:31: law.gamma: found a number in s"));
  EXPECT_THAT(problemsOf([&] { static_cast<void>(check(options.file, {})); }), one);
  EXPECT_THAT(problemsOf([&] { static_cast<void>(programsOfRun(options)); }), one);
  EXPECT_THAT(problemsOf([&] { static_cast<void>(run(options, {})); }), one);
}

TEST(ProgramCommand, SaysThatAnExperimentFileIsNone) {
  const TemporaryFolder folder;
  const fs::path file = folder / "x.toml";
  support::writeFile(file, std::string(kSmall));

  EXPECT_THAT(
      problemsOf([&] { static_cast<void>(loadProgram(file.string())); }),
      ElementsAre(HasSubstr("x.toml:1:15: fileversion: found an experiment file, allowed the "
                            "file of one program of motion (docs/programs.md); an "
                            "experiment is checked with its programs by ./lab check ")));
}

TEST(ProgramCommand, ShowsNumbersWithoutUnitAsSuch) {
  const TemporaryFolder folder;
  const fs::path file = folder / "mine.toml";
  std::string text = kProgram;
  text.erase(0, text.find('\n') + 1);
  support::writeFile(file, text);

  const std::string dut = describeProgram(loadProgram(file.string()));

  EXPECT_THAT(dut, HasSubstr("parameter share = 0.3\n"));
  EXPECT_THAT(dut, HasSubstr("parameter v = 5 cm/s\n"));
  EXPECT_THAT(dut, Not(HasSubstr("warning")));
}

TEST(ProgramCommand, WarnsOfHoldsThatARobotLengthens) {
  const TemporaryFolder folder;
  const fs::path file = folder / "mine.toml";
  support::writeFile(file, "[phases.run]\nturn = \"normal(0, 1)*1/s\"\nhold = \"2 ms\"\n");

  EXPECT_THAT(describeProgram(loadProgram(file.string())),
              HasSubstr("warning: phases.run.hold: is 2 ms, but the robot needs up to "));
}

}  // namespace
}  // namespace lab::runner::program_command_test
