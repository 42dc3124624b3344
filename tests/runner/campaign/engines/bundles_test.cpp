#include "runner/campaign/engines/bundles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign::bundles_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// A folder of a stranger: quotes, substitutions, options.
constexpr const char* kFolder = "/data/it's \"$(touch evil)\" `touch evil`; -x & \\ #";
const std::vector<std::string> kControlled{"/a\ntouch evil", "/a\rb", "/a\tb", "/a\x1b[2J",
                                           "/a\x7f"};

std::string printedBy(const std::string& command) {
  std::FILE* const shell = popen(command.c_str(), "r");
  if (shell == nullptr) throw std::runtime_error("no shell");
  std::string text;
  std::array<char, 256> buffer{};
  while (const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), shell)) {
    text.append(buffer.data(), read);
  }
  EXPECT_EQ(pclose(shell), 0) << command;
  return text;
}

TEST(ShellWord, IsOneWordForAShell) {
  for (const char* text : {"plain/1.0", "", " ", "it's", "$HOME", "`id`", "$(id)", "a\\b", "\"",
                           "*", "~", "a;b", "ä", kFolder}) {
    EXPECT_EQ(printedBy("printf '<%s>' " + shellWord(text)), "<" + std::string(text) + ">");
  }
}

TEST(ShellWord, HasNoControlCharacters) {
  for (const std::string& text : kControlled) {
    EXPECT_THROW(static_cast<void>(shellWord(text)), UserError);
  }
}

TEST(ScriptPaths, AreRefusedWithControlCharacters) {
  for (const std::string& text : kControlled) {
    for (const char* engine : {"slurm", "parallel", "snakemake", "commands"}) {
      EXPECT_THROW(requireScriptable(text, engine), UserError);
    }
    EXPECT_THROW(static_cast<void>(slurmScript("x", "/lab", text, "/list")), UserError);
    EXPECT_THROW(static_cast<void>(snakefileText("/lab", text, {{0}})), UserError);
    EXPECT_THROW(static_cast<void>(commandsText("/lab", text, {{0}})), UserError);
  }
  EXPECT_NO_THROW(requireScriptable(kFolder, "slurm"));
}

TEST(ScriptPaths, HaveNoPerlForGnuParallel) {
  EXPECT_THROW(requireScriptable("/a{=system(\"touch evil\")=}", "parallel"), UserError);
  EXPECT_THROW(requireScriptable("/a{}", "parallel"), UserError);
  EXPECT_NO_THROW(requireScriptable("/a{}", "commands"));
  EXPECT_NO_THROW(requireScriptable(kFolder, "parallel"));
}

TEST(SlurmScript, NamesItsPathsInQuotesOnly) {
  const std::string script =
      slurmScript("scan", "/lab", kFolder, fs::path(kFolder) / "slurm/bundles-1.txt");

  EXPECT_THAT(script, HasSubstr("\n#SBATCH --job-name=scan\n"));
  EXPECT_EQ(std::ranges::count(script, '\n'), 7);
  EXPECT_THAT(script, HasSubstr("exec /lab sweep " + shellWord(kFolder) + " --rows \"$rows\"\n"));
  // sbatch reads options from comments.
  EXPECT_THAT(script.substr(0, script.find("rows=")), Not(HasSubstr("touch")));
}

}  // namespace
}  // namespace lab::runner::campaign::bundles_test
