#include <gmock/gmock.h>

#include "tests/support/experiment_samples.hpp"
#include "tests/support/programs.hpp"

namespace lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Overrides, ReplaceValuesOfTheFile) {
  const Experiment dut = small({}, {"duration_s=5", "programs.abp.v_cm_s = 4.5", "robots[0].id=7"});

  EXPECT_EQ(dut.duration, 5);
  EXPECT_EQ(test::parameter(dut.programs.at("abp"), "v"), 0.045);
  EXPECT_EQ(dut.robots[0].id, 7);
}

TEST(Overrides, CreateMissingTables) {
  const Experiment dut = small({}, {"camera.fps=25", "programs.slow.model=bp",
                                    "programs.slow.V_cm_s=1", "programs.slow.epsilon_s=0.2"});

  EXPECT_EQ(dut.camera.fps, 25);
  EXPECT_EQ(test::parameter(dut.programs.at("slow"), "V"), 0.01);
}

TEST(Overrides, TakeABareWordAsText) {
  EXPECT_EQ(small({}, {"name=renamed"}).name, "renamed");
  EXPECT_EQ(small({}, {"name=\"quoted\""}).name, "quoted");
  EXPECT_EQ(small({}, {"description=two words, and = a sign"}).description,
            "two words, and = a sign");
  EXPECT_EQ(small({}, {"description="}).description, "");
}

TEST(Overrides, ReplaceListsAndTheirElements) {
  const Experiment dut = small("[light_table]\nhysteresis = 0\n",
                               {"light.steps=[{at_s = 0, layers = [{kind = \"uniform\", intensity "
                                "= 0.25}]}]",
                                "light.steps[0].layers[0].intensity=0.75"});

  EXPECT_EQ(dut.light.steps[0].layers[0].intensity, 0.75);
}

TEST(Overrides, AreAppliedInOrder) {
  EXPECT_EQ(small({}, {"duration_s=1", "duration_s=2"}).duration, 2);
}

TEST(Overrides, AreNamedInProblemsInsteadOfALine) {
  EXPECT_THAT(problemsOf("", {"duration_s=abc"}),
              ElementsAre("--set duration_s=abc: duration_s: found \"abc\", allowed numbers: "
                          "0.001 to 864000"));
  EXPECT_THAT(problemsOf("", {"robot.diametre_cm=7"}),
              ElementsAre("--set robot.diametre_cm=7: robot.diametre_cm: found an unknown key, "
                          "allowed here is diameter_cm"));
  EXPECT_THAT(problemsOf("", {"robots[0]={id = 1, x_cm = 130, y_cm = 45, theta_deg = 0}"}),
              ElementsAre(HasSubstr("robots[0].x_cm: found 130, allowed 3.75 to 116.25")));
}

TEST(Overrides, WithoutAPlaceInTheFileAreRefused) {
  EXPECT_THAT(problemsOf("", {"robots[3].id=4"}),
              ElementsAre("--set robots[3].id=4: found no such place in the file, allowed a path "
                          "to a key"));
  EXPECT_THAT(problemsOf("", {"duration_s.x=4"}), ElementsAre(HasSubstr("found no such place")));
  EXPECT_THAT(problemsOf("", {"duration_s[0]=4"}), ElementsAre(HasSubstr("found no such place")));
  EXPECT_THAT(problemsOf("", {"robots[1]=4"}), ElementsAre(HasSubstr("found no such place")));
}

TEST(Overrides, WithoutPathOrValueAreRefused) {
  EXPECT_THAT(problemsOf("", {"duration_s"}),
              ElementsAre(StartsWith("--set duration_s: found no value")));
  for (const char* key : {"=1", ".=1", "a..b=1", "a[=1", "a[]=1", "a[-1]=1", "a[x]=1", "a[0]b=1",
                          "a b=1", "a.=1", "a[99999999999999999999]=1"}) {
    EXPECT_THAT(problemsOf("", {key}), ElementsAre(HasSubstr("allowed a path"))) << key;
  }
}

TEST(Overrides, CannotSetASecondKey) {
  EXPECT_THAT(problemsOf("", {"duration_s=5\nseed=3"}),
              ElementsAre(HasSubstr("duration_s: found \"5 seed=3\"")));
}

TEST(Overrides, WithInvalidUtf8AreRefused) {
  EXPECT_THAT(problemsOf("", {"name=\xff\xfe"}), ElementsAre(HasSubstr("allowed UTF-8")));
}

TEST(Overrides, ReportAllProblems) {
  EXPECT_THAT(problemsOf("", {"a", "b"}),
              ElementsAre(StartsWith("--set a"), StartsWith("--set b")));
}

}  // namespace
}  // namespace lab
