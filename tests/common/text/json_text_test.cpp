#include "common/text/json_text.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
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

TEST(JsonText, TakesWholeNumbersWithinLimitsOnly) {
  const auto taken = [](const char* text) { return wholeNumber(parseJsonText(text), -3, 300); };
  EXPECT_EQ(taken("-3"), -3);
  EXPECT_EQ(taken("300"), 300);
  for (const char* text : {"-4", "301", "2.5", "1e2", "1e300", "-1e300", "true", "\"1\"", "null",
                           "18446744073709551615", "-9223372036854775808"}) {
    EXPECT_THROW(static_cast<void>(taken(text)), std::out_of_range) << text;
  }
}

}  // namespace
}  // namespace lab
