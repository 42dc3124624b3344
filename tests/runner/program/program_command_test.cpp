#include "runner/program/program_command.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/run_command.hpp"
#include "runner/program/program_trace.hpp"
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

std::string traceOf(const std::string& text, TraceOptions options = {}) {
  const TemporaryFolder folder;
  const fs::path file = folder / "mine.toml";
  support::writeFile(file, text);
  return traceProgram(loadProgram(file.string()), options);
}

/// The lines of the table of holds.
std::vector<std::string> holdsOf(const std::string& trace) {
  std::istringstream lines(trace.substr(trace.find("t (s)")));
  std::vector<std::string> holds;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string all;
    for (std::string word; words >> word;) all += (all.empty() ? "" : " ") + word;
    holds.push_back(all);
  }
  return holds;
}

constexpr const char* kUntil = R"toml([phases.one]
forward = "5 cm/s"
hold = "10 s"
until = "phase_time > 0.3 s"
then = "two"
[phases.two]
turn = "2 rad/s"
hold = "0.25 s"
next = "one"
)toml";

// The sensors are scanned every 20 ms, also in the second hold: 320 ms + 250 ms is before the scan
// at 580 ms, and 0.31 s after 570 ms is one at 880 ms.
TEST(ProgramTrace, EndsHoldsAsTheRobotDoes) {
  TraceOptions options;
  options.holds = 4;
  EXPECT_THAT(holdsOf(traceOf(kUntil, options)),
              ElementsAre("0.000 one 5.0000 5.0000 0.0000 0.320 until -",
                          "0.320 two -7.5000 7.5000 2.0000 0.250 -",
                          "0.570 one 5.0000 5.0000 0.0000 0.310 until -",
                          "0.880 two -7.5000 7.5000 2.0000 0.250 -"));
}

TEST(ProgramTrace, WaitsForAConditionInAHoldWithoutEnd) {
  std::string text = kUntil;
  text.replace(text.find("10 s"), 4, "forever");
  TraceOptions options;
  options.holds = 2;
  EXPECT_THAT(holdsOf(traceOf(text, options)),
              ElementsAre("0.000 one 5.0000 5.0000 0.0000 0.320 until -",
                          "0.320 two -7.5000 7.5000 2.0000 0.250 -"));
  text.replace(text.find("phase_time > 0.3 s"), 18, "light > 0.5");
  EXPECT_THAT(holdsOf(traceOf(text, options)),
              ElementsAre("0.000 one 5.0000 5.0000 0.0000 forever -"));
}

TEST(ProgramTrace, ShowsTheDrawsThatMakeTheHolds) {
  TraceOptions options;
  options.holds = 40;
  const std::vector<std::string> holds = holdsOf(
      traceOf("state = {x = \"uniform(1, 2)\"}\n[phases.run]\nset = {x = "
              "\"if(chance(0.5), choose(4), 7)\"}\n"
              "turn = \"uniform(-2, 2)*1/s\"\nhold = \"1 s\"\nuntil = \"uniform(0, 1) > 0.9\"\n",
              options));
  ASSERT_EQ(holds.size(), 40U);
  EXPECT_THAT(holds[0], HasSubstr(" state: uniform 1."));
  int ended = 0;
  for (const std::string& hold : holds) {
    std::istringstream words(hold);
    double t = 0, left = 0, right = 0, turn = 0, held = 0;
    std::string phase;
    words >> t >> phase >> left >> right >> turn >> held;
    const std::string rest = hold.substr(static_cast<std::size_t>(words.tellg()));
    const bool yes = rest.find("chance yes") != std::string::npos;
    ASSERT_NE(yes, rest.find("chance no") != std::string::npos) << hold;
    const double chosen = std::stod(rest.substr(rest.find("choose ") + 7));
    const double drawn = std::stod(rest.substr(rest.find("uniform ", rest.find("choose ")) + 8));
    EXPECT_NEAR(turn, drawn, 2e-4) << hold;
    EXPECT_THAT(rest, HasSubstr(yes ? fmt::format(" {:.4f} ", chosen) : " 7.0000 "));
    if (held < 1) {
      ++ended;
      EXPECT_GT(std::stod(rest.substr(rest.find("until: uniform ") + 15)), 0.9) << hold;
    }
  }
  EXPECT_GT(ended, 10);
}

TEST(ProgramTrace, ReadsWhatIsSet) {
  TraceOptions options;
  options.holds = 1;
  options.set = {"light_front=1",  "light_back=0.5", "ir(2)=0.25",
                 "sense(3)=-12.5", "battery=7.25",   "id=42"};
  const std::string text =
      "state = {a = \"light_front - light_back\", b = \"ir(2)\", c = \"sense(3)\", d = "
      "\"battery/1 volt\", e = \"id\"}\n[phases.run]\nhold = \"1 s\"\n";
  EXPECT_THAT(holdsOf(traceOf(text, options)),
              ElementsAre("0.000 run 0.0000 0.0000 0.0000 1.000 0.4995 0.2502 -12.5000 7.2500 "
                          "42.0000 -"));
}

TEST(ProgramTrace, RefusesInputsThatThereAreNot) {
  const auto problemOf = [](const std::string& setting) {
    TraceInputs inputs;
    try {
      setInput(inputs, setting);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(problemOf("ligth=1"), HasSubstr("--set: found ligth=1, expected NAME=VALUE with one "
                                              "of light (both sensors), light_front"));
  EXPECT_THAT(problemOf("ligth=1"), HasSubstr("did you mean light?"));
  EXPECT_THAT(problemOf("ir(6)=1"), HasSubstr("found ir(6)=1, expected NAME=VALUE"));
  EXPECT_EQ(problemOf("light=1.5"), "--set: found light=1.5, expected light=VALUE from 0 to 1");
  EXPECT_EQ(problemOf("id=1x"), "--set: found id=1x, expected id=VALUE from 0 to 65535");
  EXPECT_EQ(problemOf("battery=nan"),
            "--set: found battery=nan, expected battery=VALUE from 0 to 65.535 volt");
}

TEST(ProgramTrace, ShowsNamesAndUnitsAsTheyWereWritten) {
  const std::string dut = traceOf(
      "parameters = {eta = \"3 rad/s\", flick = \"90 deg\", twice = \"2*eta\"}\n"
      "state = {sign = \"1\"}\n[phases.run]\nset = {sign = \"-sign\"}\n"
      "turn = \"sign*eta*light_front\"\nhold = \"1 s\"\nnext = \"turn_back\"\n"
      "[phases.turn_back]\nturn = \"flick/1 s\"\nhold = \"1 s\"\nuntil = \"sense(3) > ir(5)\"\n");
  for (const char* part :
       {"parameter eta = 3 rad/s\n", "parameter flick = 90 deg\n",
        "parameter twice = 2*eta = 6 1/s\n", "load sign ", "store sign ", "read light_front ",
        "push phase turn_back ", "phase turn_back\n", "phase turn_back, until\n", "read sense(3) ",
        "read ir(5) ", " turn (rad/s) "}) {
    EXPECT_THAT(dut, HasSubstr(part));
  }
}

}  // namespace
}  // namespace lab::runner::program_command_test
