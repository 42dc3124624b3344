#include "common/files/toml_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "common/files/experiment_error.hpp"
#include "common/files/toml_document.hpp"

namespace lab::keys {
namespace {

std::string repeated(std::size_t count, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

/// The line of a key that is refused for its many names; 0: there is none.
std::size_t lineOfDeepKey(const std::string& text) {
  try {
    static_cast<void>(parseToml(text, "x.toml"));
  } catch (const TomlError& error) {
    return error.at().column == 0 ? error.at().line : 0;
  }
  return 0;
}

TEST(ParseToml, RefusesKeysAndHeadersOfManyNames) {
  EXPECT_EQ(lineOfDeepKey("x = 1\n" + repeated(kMostNames, "a.") + "a = 1"), 2U);
  EXPECT_EQ(lineOfDeepKey(repeated(kMostNames - 1, "a.") + "a = 1"), 0U);
  EXPECT_EQ(lineOfDeepKey("\n\n[" + repeated(kMostNames, "a.") + "a]"), 3U);
  EXPECT_EQ(lineOfDeepKey("x = {" + repeated(kMostNames, "\"b\" . ") + "a = 1}"), 1U);
  EXPECT_EQ(lineOfDeepKey(repeated(kMostNames, "'#'.") + "a = 1"), 1U);
  for (const std::string text :
       {"\"\"\"\"a\"\"\"\"", "\"\"\"a\"\"\"\"\"", "'''a''''", "\"\"\"\"\"\""}) {
    EXPECT_EQ(lineOfDeepKey("x = {y = " + text + ", " + repeated(kMostNames, "a.") + "a = 1}"), 1U)
        << text;
  }
}

TEST(ParseToml, ReadsDotsOfNumbersTextsAndComments) {
  EXPECT_EQ(lineOfDeepKey("x = [" + repeated(100, "1.5, ") + "2.5]"), 0U);
  EXPECT_EQ(lineOfDeepKey("# " + repeated(100, "a.")), 0U);
  EXPECT_EQ(
      lineOfDeepKey("x = \"\\\"" + repeated(100, "a.") + "\"\ny = '" + repeated(100, "a.") + "'"),
      0U);
  EXPECT_EQ(lineOfDeepKey("x = \"\"\"\n\"" + repeated(100, "a.\n") + "\"\"\"\ny = '''" +
                          repeated(100, "a.") + "'''"),
            0U);
  EXPECT_EQ(lineOfDeepKey("x = \"not closed" + repeated(100, "a.")), 0U) << "another problem";
}

TEST(ParseToml, KeepsADocumentAndASettingFromOverflowingTheStack) {
  const std::string deep = repeated(100'000, "a.") + "a";
  EXPECT_THAT([&] { TomlDocument(deep + " = 1\n", "x.toml", {}); },
              testing::ThrowsMessage<ExperimentError>(
                  "x.toml:1: found a key of more than 32 names, which no file of the lab has"));
  EXPECT_THAT([&] { TomlDocument("", "x.toml", {deep + "=1"}); },
              testing::ThrowsMessage<ExperimentError>(
                  testing::EndsWith("...: found a path of 100001 names, allowed at most 32")));
  const TomlDocument dut("", "x.toml", {"x={" + deep + "=1}"});
  EXPECT_TRUE(dut.root().at("x").is_string()) << "a text, as what is no TOML";
}

}  // namespace
}  // namespace lab::keys
