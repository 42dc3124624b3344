#include "runner/campaign/axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign::axis_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusalOf(const std::string& text) {
  try {
    static_cast<void>(parseAxes({text}));
  } catch (const UserError& error) {
    return error.what();
  }
  return {};
}

TEST(Axis, TakesValuesAsTheyAreWritten) {
  EXPECT_THAT(parseAxis("duration_s=60, 120,600").values, ElementsAre("60", "120", "600"));
  EXPECT_THAT(parseAxis("program=abp,rtp").values, ElementsAre("abp", "rtp"));
  EXPECT_THAT(parseAxis("a.b=[1, 2],[3, 4]").values, ElementsAre("[1, 2]", "[3, 4]"));
  EXPECT_THAT(parseAxis("a.text=\"x,y\",'z:1:2'").values, ElementsAre("\"x,y\"", "'z:1:2'"));
}

TEST(Axis, SpacesTheValuesOfARangeEqually) {
  EXPECT_THAT(parseAxis("k=0.1:0.9:9").values,
              ElementsAre("0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9"));
  EXPECT_THAT(parseAxis("k=0.01:100:5:log").values, ElementsAre("0.01", "0.1", "1", "10", "100"));
  EXPECT_THAT(parseAxis("k=1:40:4:whole").values, ElementsAre("1", "14", "27", "40"));
  EXPECT_THAT(parseAxis("k=0.1:1:3:log:round=0.01").values, ElementsAre("0.1", "0.32", "1"));
}

TEST(Axis, KeepsARangeWithoutCountForDrawing) {
  const Axis axis = parseAxis("programs.abp.eta_rad_s=0.5:4:log");

  ASSERT_TRUE(axis.range.has_value());
  EXPECT_TRUE(axis.values.empty());
  EXPECT_EQ(axis.range->low, 0.5);
  EXPECT_EQ(axis.range->high, 4);
  EXPECT_TRUE(axis.range->logarithmic);
  EXPECT_TRUE(axis.isNumeric());
}

TEST(Axis, NamesTheQuantityAndItsUnit) {
  EXPECT_EQ(parseAxis("programs.abp.eta_rad_s=1").symbol(), "eta");
  EXPECT_EQ(parseAxis("programs.abp.eta_rad_s=1").unit(), "rad/s");
  EXPECT_EQ(parseAxis("robots[0].count=5").symbol(), "count");
  EXPECT_EQ(parseAxis("robots[0].count=5").unit(), "");
  EXPECT_FALSE(parseAxis("program=abp,rtp").isNumeric());
}

TEST(Axis, RefusesWhatCannotBeMeant) {
  EXPECT_THAT(refusalOf("eta"), HasSubstr("found no key with values"));
  EXPECT_THAT(refusalOf("k=1,,2"), HasSubstr("empty value"));
  EXPECT_THAT(refusalOf("k=1,2,1"), HasSubstr("found 1 twice"));
  EXPECT_THAT(refusalOf("k=2:1:5"), HasSubstr("expected one that rises"));
  EXPECT_THAT(refusalOf("k=0:1:5:log"), HasSubstr("expected a positive number"));
  EXPECT_THAT(refusalOf("k=0:1:1"), HasSubstr("expected 2 to"));
  EXPECT_THAT(refusalOf("k=0:1:round=0"), HasSubstr("positive number after round="));
  EXPECT_THAT(refusalOf("seed=1,2"), HasSubstr("--seeds N"));
  EXPECT_THAT(refusalOf("k=1:3:9:whole"), HasSubstr("twice"));
}

TEST(Axis, NamesTheOptionThatWasGiven) {
  EXPECT_THAT(refusalOf("eta"), testing::StartsWith("--over eta: "));
  EXPECT_THAT([] { static_cast<void>(parseAxes({"eta"}, "--fit")); },
              testing::ThrowsMessage<UserError>(testing::StartsWith("--fit eta: ")));
}

TEST(Axis, RefusesAKeyThatIsGivenTwice) {
  EXPECT_THROW(static_cast<void>(parseAxes({"k=1,2", "k=3"})), UserError);
}

}  // namespace
}  // namespace lab::runner::campaign::axis_test
