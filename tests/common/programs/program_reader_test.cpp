#include "common/programs/program_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "common/programs/program.hpp"

namespace lab {
namespace {

/// Reads a program with a description of that length.
/// @return the problems in one text
std::string readWithDescription(std::size_t length, ProgramFile& program) {
  const std::string text = "description = \"" + std::string(length, 'x') +
                           "\"\n[phases.run]\nforward = \"1 cm/s\"\nhold = \"1 s\"\n";
  const keys::TomlDocument document(text, "p.toml", {});
  keys::Problems problems([&](const std::string& path) { return document.place(path); });
  program = readProgramTable(document, document.root(), "", "p", {kWidestWheels, {}, {}}, problems);
  std::string all;
  for (const std::string& line : problems.lines(20)) all += line + "\n";
  return all;
}

TEST(ProgramReader, DoesNotCompileATextThatIsTooLong) {  // many names take minutes
  ProgramFile program;
  EXPECT_EQ(readWithDescription(kLongestProgramText / 2, program), "");
  EXPECT_FALSE(program.compiled.code.empty());
  EXPECT_THAT(readWithDescription(kLongestProgramText, program),
              testing::HasSubstr("bytes, allowed at most 4000"));
  EXPECT_TRUE(program.compiled.code.empty());
}

}  // namespace
}  // namespace lab
