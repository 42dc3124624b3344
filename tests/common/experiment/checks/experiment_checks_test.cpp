// Values that are just allowed. wrong_experiments/ has those that are not.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/support/experiment_samples.hpp"

namespace lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kThreeBands = R"([light_table]
bands = [
  {light = [0.0, 0.4], program = "a"},
  {light = [0.4, 0.6], program = "b"},
  {light = [0.6, 1.0], program = "a"},
]
)";

std::vector<std::string> problemsOfBands(const std::string& hysteresis) {
  const std::string text =
      "fileversion = 1\nname = \"x\"\nduration_s = 1\n[[robots]]\nid = 1\n[[light.steps]]\nat_s = "
      "0\nlayers = [{kind = \"uniform\", intensity = 0}]\n[programs.a]\nmodel = \"stand\"\n"
      "[programs.b]\nmodel = \"wheels\"\nleft_cm_s = 1\nright_cm_s = 1\n";
  try {
    static_cast<void>(
        parseExperiment(text + kThreeBands, "x.toml", {"light_table.hysteresis=" + hysteresis}));
  } catch (const ExperimentError& error) {
    return error.problems();
  }
  return {};
}

TEST(ExperimentCheck, AllowsWheelsToReachTheirLimitExactly) {
  EXPECT_THAT(problemsOf("", {"programs.abp.eta_rad_s=6.4"}), IsEmpty());
  EXPECT_THAT(problemsOf("", {"programs.abp.eta_rad_s=6.41"}), SizeIs(1));
  EXPECT_THAT(problemsOf("", {"programs.abp.eta_rad_s=6.41", "robot.max_wheel_speed_cm_s=27.1"}),
              IsEmpty());
}

TEST(ExperimentCheck, AllowsHoldsOfOneMillisecondToOneHour) {
  EXPECT_THAT(problemsOf("", {"programs.abp.epsilon_s=0.001"}), IsEmpty());
  EXPECT_THAT(problemsOf("", {"programs.abp.epsilon_s=0.0004"}), SizeIs(1));
  EXPECT_THAT(problemsOf("", {"programs.abp.epsilon_s=3600"}), IsEmpty());
  EXPECT_THAT(problemsOf("", {"programs.abp.epsilon_s=3601"}), SizeIs(1));
}

TEST(ExperimentCheck, AllowsAsManyRobotsAsHaveRoom) {
  EXPECT_THAT(problemsOf("", {"robots[0].count=146"}), IsEmpty());
  EXPECT_THAT(problemsOf("", {"robots[0].count=147"}), SizeIs(1));
  EXPECT_THAT(problemsOf("", {"robots[0].count=250", "robot.diameter_cm=5"}), IsEmpty());
}

TEST(ExperimentCheck, RefusesOverlappingRobots) {
  const auto problems = [](const char* x) {
    std::string text(kSmall);
    text.replace(text.find("[programs"), 0,
                 "x_cm=60\ny_cm=45\ntheta_deg=0\n[[robots]]\nid = 2\n" +
                     std::string("y_cm=45\ntheta_deg=0\nx_cm=") + x + "\n");
    try {
      static_cast<void>(parseExperiment(text, "x.toml"));
    } catch (const ExperimentError& error) {
      return error.problems();
    }
    return std::vector<std::string>{};
  };
  EXPECT_THAT(problems("67.6"), IsEmpty());
  EXPECT_THAT(problems("67.4"), ElementsAre(HasSubstr("robots[1].x_cm: found a place 7.4 cm")));
}

TEST(ExperimentCheck, LimitsTheHysteresisByTheBands) {
  EXPECT_THAT(problemsOfBands("0.099"), IsEmpty());
  EXPECT_THAT(problemsOfBands("0.1"), ElementsAre(HasSubstr("found 0.1, allowed below 0.1")));
}

TEST(ExperimentCheck, IgnoresTheSpeedOfReversalsThatAreOff) {
  EXPECT_THAT(problemsOf("", {"reversal.speed_cm_s=100", "reversal.on=never"}), IsEmpty());
}

TEST(ExperimentCheck, StopsAfterTwentyProblems) {
  std::string robots;
  for (int i = 0; i < 30; ++i) robots += "[[robots]]\nid = 0\n";

  const auto problems = problemsOf(robots);

  ASSERT_THAT(problems, SizeIs(21));
  EXPECT_EQ(problems.back(), "... and 10 more");
}

TEST(ExperimentCheck, ReportsProblemsInTheOrderOfTheFile) {
  EXPECT_THAT(problemsOf("[faults]\nmessage_loss = 2\n[camera]\nfps = 0\n"),
              ElementsAre(HasSubstr("small.toml:13: faults"), HasSubstr("small.toml:15: camera")));
}

TEST(ExperimentCheck, SkipsChecksOfWrongValues) {
  EXPECT_THAT(problemsOf("[arena]\nwidth_cm = \"wide\"\n", {"robots[0].count=200"}),
              ElementsAre(HasSubstr("arena.width_cm: found \"wide\"")));
  EXPECT_THAT(problemsOf("[[light.steps]]\nat_s = 10\nlayers = 3\n"),
              ElementsAre(HasSubstr("light.steps[0].layers: found 3")));
}

}  // namespace
}  // namespace lab
