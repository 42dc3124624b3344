#include "common/programs/program_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "robot/dynamics/byte_code.hpp"

namespace lab::program_file_test {
namespace {

const std::filesystem::path kPrograms = LAB_MOTION_PROGRAMS;

std::string fileText(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ProgramFile, EveryShippedProgramFitsIntoARobot) {
  std::size_t programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kPrograms)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string();
    const ProgramFile program = readProgram(fileText(entry.path()), entry.path().string(), name);
    EXPECT_FALSE(program.text.description.empty()) << name;
    EXPECT_LE(program.compiled.code.size(), dynamics::kLargestProgram) << name;
    EXPECT_EQ(dynamics::checkByteCode(program.compiled.code.data(),
                                      static_cast<std::uint16_t>(program.compiled.code.size()))
                  .fault,
              dynamics::kValidByteCode)
        << name;
    ++programs;
  }
  EXPECT_GE(programs, 16U);
}

TEST(ProgramFile, PhasesKeepTheOrderOfTheFile) {
  const ProgramFile program = readProgram(
      "[phases.run]\nforward = \"1 cm/s\"\nhold = \"1 s\"\nnext = \"after\"\n"
      "[phases.after]\nhold = \"1 s\"\nnext = \"run\"\n",
      "x.toml", "x");
  ASSERT_EQ(program.text.phases.size(), 2U);
  EXPECT_EQ(program.text.phases[0].name, "run");
}

TEST(ProgramFile, AssignmentsKeepTheOrderOfTheFile) {
  const ProgramFile program = readProgram(
      "state = {b = \"0\", a = \"1\"}\n[phases.run]\nset = {b = \"a\", a = \"b\"}\n"
      "hold = \"1 s\"\n",
      "x.toml", "x");
  ASSERT_EQ(program.text.phases[0].set.size(), 2U);
  EXPECT_EQ(program.text.phases[0].set[0].first, "b");
}

struct Wrong {
  const char* text;
  const char* line;
};

class WrongProgramFile : public testing::TestWithParam<Wrong> {};

TEST_P(WrongProgramFile, IsRefusedInOneLineWithLineAndColumn) {
  try {
    static_cast<void>(readProgram(GetParam().text, "p.toml", "p"));
    FAIL() << "accepted " << GetParam().text;
  } catch (const ExperimentError& error) {
    EXPECT_EQ(error.problems()[0].find(GetParam().line), 0U) << error.problems()[0];
    EXPECT_EQ(error.problems()[0].find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongProgramFile,
    testing::Values(
        Wrong{"phases = \n", "p.toml:1:"},
        Wrong{"description = 3\n[phases.run]\nhold = \"1 s\"\n",
              "p.toml:1:15: description: found 3, allowed a text"},
        Wrong{"[phases.run]\nhold = 1\n",
              "p.toml:2:8: phases.run.hold: found 1, allowed a text: "
              "\"1\", with its unit if it has one"},
        Wrong{"[phases.run]\nhold = \"1 s\"\nforwards = \"1 cm/s\"\n",
              "p.toml:3:13: phases.run.forwards: found an unknown key, allowed here: set, forward, "
              "turn, left, right, hold, next, until, then; did you mean forward?"},
        Wrong{"parameter = {}\n[phases.run]\nhold = \"1 s\"\n",
              "p.toml:1:13: parameter: found an unknown key, allowed here: description, law, "
              "parameters, state, phases; did you mean parameters?"},
        Wrong{"phases = 3\n", "p.toml:1:10: phases: found 3, allowed a table"},
        Wrong{"description = \"nothing\"\n",
              "p.toml:1:1: phases: found no phase, expected at least one"},
        Wrong{"parameters = {\u03b3 = \"0.5 1/s\"}\n",
              "p.toml:1:15: found the name \u03b3, allowed letters a to z, digits and _; write "
              "gamma"},
        Wrong{"[parameters]\nv = \"\u03b7\"\n\u03b7 = \"0.5 1/s\"\n",
              "p.toml:3:1: found the name \u03b7, allowed letters a to z, digits and _; write eta"},
        Wrong{"[phases.run]\nforward = \"1 cm/s\"\n", "p.toml:1:1: phases.run: has no hold"},
        Wrong{"[phases.run]\nforward = \"1 cm/s + 2 s\"\nhold = \"1 s\"\n",
              "p.toml:2:21: phases.run.forward: '2 s' is a number in s, expected a number in cm/s "
              "like '1 cm/s'"},
        Wrong{"[phases.run]\nhold = \"\"\n", "p.toml:2:9: phases.run.hold: found an empty text"},
        Wrong{"[phases.run]\nhold = \"1 s\"\nnext = \"walk\"\n",
              "p.toml:3:9: phases.run.next: unknown name 'walk'"}));

}  // namespace
}  // namespace lab::program_file_test
