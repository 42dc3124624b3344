#include "common/experiment/script_plan.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/experiment/experiment_describe.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(ScriptPlan, CountsTheStepsOfARun) {
  const LightScript nested = small(kWaiting, {"light.repeat=true"}).light;
  const std::vector<double> holds{1, 2, 3, 4};
  // A pass takes 45 s and has 18 steps.
  EXPECT_EQ(countSteps(nested, holds, 450, 1000).steps, 180);
  EXPECT_EQ(countSteps(nested, holds, 451, 1000).steps, 181);
  EXPECT_EQ(countSteps(nested, holds, 3, 1000).steps, 2);
  EXPECT_EQ(countSteps(small(kWaiting).light, holds, 450, 1000).steps, 18);
  const ShownSteps stopped = countSteps(nested, holds, 1e300, 36);
  EXPECT_EQ(stopped.steps, 36);
  EXPECT_EQ(stopped.time, 90);
  EXPECT_EQ(countSteps(small().light, {std::numeric_limits<double>::infinity()}, 60, 10).steps, 1);
}

/// Of a file that is to be played.
std::vector<std::string> problemsOfSteps(const std::string& steps) {
  const std::string text = std::string(kSmall) + "[light]\nrepeat = true\n" + steps;
  try {
    static_cast<void>(parseExperiment(text, "steps.toml", {}, "."));
  } catch (const ExperimentError& error) {
    return error.problems();
  }
  return {};
}

TEST(ScriptPlan, AllowsStepsAndPassesOfTenMilliseconds) {
  constexpr const char* kLayers = "layers = [{kind = \"uniform\", intensity = 0.5}]\n";
  const auto at = [&](const std::string& length, const std::string& second) {
    return problemsOfSteps("length_s = " + length + "\n[[light.steps]]\nat_s = 0\n" + kLayers +
                           "[[light.steps]]\nat_s = " + second + "\n" + kLayers);
  };
  EXPECT_THAT(at("0.3", "0.29"), IsEmpty());
  EXPECT_THAT(at("0.3", "0.2901"),
              ElementsAre(HasSubstr("light.length_s: found 0.3, allowed at least 0.3001")));
  EXPECT_THAT(at("0.3", "0.0099"),
              ElementsAre(HasSubstr("light.steps[1].at_s: found 0.0099, allowed at least 0.01")));
  const auto held = [&](const std::string& hold) {
    return problemsOfSteps("[[light.steps]]\nhold_s = " + hold + "\n" + kLayers);
  };
  EXPECT_THAT(held("0.01"), IsEmpty());
  EXPECT_THAT(held("1e-300"), ElementsAre(HasSubstr("light.steps[0].hold_s: found")));
}

}  // namespace
}  // namespace lab
