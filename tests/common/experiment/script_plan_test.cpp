#include "common/experiment/script_plan.hpp"

#include <gmock/gmock.h>

#include "common/experiment/experiment_describe.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kWaiting = R"([[light.steps]]
label = "a"
hold_s = 1
layers = [{kind = "uniform", intensity = 0.5}]
[[light.steps]]
label = "b"
hold_s = 2
until = {estimate = "D_r", program = "abp", relative_error = 0.05}
if_not = "safe"
layers = [{kind = "uniform", intensity = 0.5}]
[[light.steps]]
hold_s = 3
until = {robots = "all", region = "rectangle", x_cm = 60, y_cm = 45, width_cm = 20, height_cm = 10}
back_to = "b"
times = 2
layers = [{kind = "uniform", intensity = 0.5}]
[[light.steps]]
hold_s = 4
until = {robot = 1, region = "circle", x_cm = 60, y_cm = 45, radius_cm = 10}
back_to = "a"
times = 3
layers = [{kind = "uniform", intensity = 0.5}]
)";

TEST(ScriptPlan, AddsUpTheLimitsOfAllRepetitions) {
  EXPECT_THAT(latestStartTimes({1, 2, 3, 4}, {{1, 2, 2}, {0, 3, 3}}), ElementsAre(0, 1, 3, 11, 45));
  EXPECT_THAT(latestStartTimes({0.1, 0.2, 0.3}, {}), ElementsAre(0, 0.1, 0.3, 0.6));
}

TEST(ScriptPlan, IsReadBackAsWritten) {
  const Experiment dut = small(kWaiting);
  EXPECT_EQ(dut.light.steps[3].at, 11);
  EXPECT_EQ(dut.light.steps[1].until.relative_error, 0.05);
  EXPECT_EQ(dut.light.steps[2].until.who, Who::kAll);
  EXPECT_EQ(dut.light.steps[2].until.width, 0.2);
  EXPECT_EQ(dut.light.steps[3].until.robot, 1);
  EXPECT_EQ(parseExperiment(writeExperiment(dut), "written"), dut);
}

TEST(ScriptPlan, WithFixedTimesIsWrittenWithoutHoldTimes) {
  const Experiment dut = small(
      "[[light.steps]]\nhold_s = 3\nlayers = [{kind = \"uniform\", intensity = 0.5}]\n"
      "[[light.steps]]\nhold_s = 3\nlayers = [{kind = \"uniform\", intensity = 0.5}]\n");
  EXPECT_TRUE(dut.light.isPlanned());
  EXPECT_THAT(writeExperiment(dut), HasSubstr("at_s = 3\n"));
  EXPECT_EQ(writeExperiment(dut).find("hold_s"), std::string::npos);
}

TEST(ScriptPlan, IsDescribedWithItsConditions) {
  const std::string dut = describeExperiment(small(kWaiting));
  EXPECT_THAT(dut, HasSubstr("run           at most 60 s"));
  EXPECT_THAT(dut, HasSubstr("  1 s b: light 0.5, abp; until D_r of abp is known to 5 %, at most 2 "
                             "s, if not: the safe light, and the run ends\n"));
  EXPECT_THAT(dut,
              HasSubstr("  by 3 s step 3: light 0.5, abp; until all robots are in the rectangle "
                        "of 20 x 10 cm around 60, 45 cm, at most 3 s, if not: the script goes "
                        "on; back to \"b\", 2 times in all\n"));
  EXPECT_THAT(dut, HasSubstr("until robot 1 is in the circle of radius 10 cm around 60, 45 cm"));
  EXPECT_THAT(dut, HasSubstr("log           at most about"));
}

TEST(ScriptPlan, TellsWhetherARunMayEndEarly) {
  EXPECT_TRUE(mayEndEarly(small(kWaiting).light));
  EXPECT_TRUE(mayEndEarly(small(kWaiting, {"light.repeat=true"}).light));
  EXPECT_FALSE(
      mayEndEarly(small(kWaiting, {"light.repeat=true", "light.steps[1].if_not=next"}).light));
  EXPECT_FALSE(mayEndEarly(small().light));
}

TEST(ScriptCursor, IteratesOverNestedGroupsInEveryPass) {
  ScriptCursor dut(small(kWaiting, {"light.repeat=true"}).light);
  std::vector<std::size_t> shown;
  while (dut.pass() < 2) {
    shown.push_back(dut.index());
    EXPECT_FALSE(dut.isLast());
    dut.advance();
  }
  ASSERT_EQ(shown.size(), 2 * 3 * 6U);
  EXPECT_THAT(std::vector(shown.begin(), shown.begin() + 7), ElementsAre(0, 1, 2, 1, 2, 3, 0));
  EXPECT_EQ(shown[17], 3U);
  EXPECT_EQ(shown[18], 0U);
}

}  // namespace
}  // namespace lab
