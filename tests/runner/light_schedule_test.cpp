#include "runner/light_schedule.hpp"

#include <gtest/gtest.h>

namespace lab::runner {
namespace {

/// Steps at 0 s and 2 s of a pass of 5 s.
LightScript twoSteps(bool repeat) {
  LightScript script;
  script.steps.resize(2);
  script.steps[1].at = 2;
  script.length = 5;
  script.repeat = repeat;
  return script;
}

TEST(LightSchedule, FollowsTheScriptOnce) {
  const LightScript script = twoSteps(false);
  EXPECT_EQ(scheduledStep(script, 100, 0)->at, 0);
  EXPECT_EQ(scheduledStep(script, 100, 1)->at, 2);
  EXPECT_EQ(scheduledStep(script, 100, 2), std::nullopt);
}

TEST(LightSchedule, RepeatsPassAfterPassUntilTheRunEnds) {
  const LightScript script = twoSteps(true);
  const auto third_pass = scheduledStep(script, 100, 5);
  ASSERT_TRUE(third_pass);
  EXPECT_EQ(third_pass->at, 12);
  EXPECT_EQ(third_pass->index, 1U);
  EXPECT_EQ(third_pass->number, 5);
  EXPECT_EQ(scheduledStep(script, 12, 5), std::nullopt);
}

TEST(LightSchedule, AnEmptyScriptHasNoStep) {
  EXPECT_EQ(scheduledStep(LightScript{}, 100, 0), std::nullopt);
}

}  // namespace
}  // namespace lab::runner
