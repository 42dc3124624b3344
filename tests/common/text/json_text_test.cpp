#include "common/text/json_text.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace lab {
namespace {

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + "1" + std::string(depth, ']');
}

TEST(JsonText, CountsBracketsWithinEachOtherOutsideOfStrings) {
  EXPECT_FALSE(isNestedDeeper("", 0));
  EXPECT_FALSE(isNestedDeeper("[[1], {\"a\": [2]}, [3]]", 3));
  EXPECT_TRUE(isNestedDeeper("[[1], {\"a\": [2]}, [3]]", 2));
  EXPECT_FALSE(isNestedDeeper(R"({"[[[[": "{{\"[[[\\"})", 1));
  EXPECT_TRUE(isNestedDeeper(R"({"a\\": [1]})", 1));
}

TEST(JsonText, ParsesWhatFilesOfTheLabHave) {
  EXPECT_EQ(parseJsonText(R"({"a": [1, 2]})").dump(), R"({"a":[1,2]})");
  EXPECT_TRUE(parseJsonText(nested(kDeepestJson)).is_array());
}

TEST(JsonText, DiscardsWhatIsDamagedOrNestedTooDeep) {
  EXPECT_TRUE(parseJsonText("").is_discarded());
  EXPECT_TRUE(parseJsonText(R"({"a": )").is_discarded());
  EXPECT_TRUE(parseJsonText(nested(kDeepestJson + 1)).is_discarded());
  EXPECT_TRUE(parseJsonText(nested(1'000'000)).is_discarded());
}

}  // namespace
}  // namespace lab
