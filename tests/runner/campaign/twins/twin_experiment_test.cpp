#include "runner/campaign/twins/twin_experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/camera/recorded_frames.hpp"
#include "common/experiment/experiment_file.hpp"

namespace lab::runner::campaign::twin_experiment_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kText = R"(fileversion = 1
name = "original"
duration_s = 60
[[robots]]
id = 1
[[robots]]
id = 2
[programs.abp]
model = "abp"
[light_table]
bands = [{light = [0.3, 1], program = "abp"}]
[light]
steps = [
  {label = "dark", layers = [{kind = "uniform", intensity = 0.1}], hold_s = 10},
  {label = "bright", layers = [{kind = "uniform", intensity = 0.9}], hold_s = 20},
]
repeat = true
[camera]
position_noise_cm = 0.05
dropout = 0.1
frame_loss = 0.1
)";

report::TwinFacts factsOf(const std::string& text) {
  report::TwinFacts facts;
  facts.experiment = parseExperiment(text, "original");
  facts.duration = 45;
  facts.ended = true;
  facts.steps = {{0, "dark", 0}, {1, "bright", 10.25}, {2, "dark", 30.5}};
  facts.first_poses = {{1, {0.3, 0.3, 1}}, {2, {0.6, 0.5, 2}}};
  facts.position_noise = 0.001;
  return facts;
}

TEST(TwinExperiment, RepeatsLightDurationAndPlacesAsRecorded) {
  const TwinExperiment twin = twinExperimentOf(factsOf(kText));
  const Experiment& experiment = twin.experiment;

  EXPECT_EQ(experiment.duration, 45);
  ASSERT_EQ(experiment.light.steps.size(), 3U);
  EXPECT_EQ(experiment.light.steps[1].at, 10.25);
  EXPECT_EQ(experiment.light.steps[2].at, 30.5);
  EXPECT_EQ(experiment.light.steps[2].label, "dark");
  EXPECT_EQ(experiment.light.steps[1].layers[0].intensity, 0.9);
  EXPECT_FALSE(experiment.light.repeat);
  EXPECT_EQ(experiment.robots[1].start, (StartPose{0.6, 0.5, 2}));
  EXPECT_THAT(twin.remarks, IsEmpty());
  EXPECT_NO_THROW(static_cast<void>(parseExperiment(writeExperiment(experiment), "twin")));
}

TEST(TwinExperiment, KeepsTheKnownNoiseOfASimulatedTrackerAndTakesLossesFromTheRecord) {
  const Experiment experiment = twinExperimentOf(factsOf(kText)).experiment;

  EXPECT_EQ(experiment.camera.position_noise, 0.0005);
  EXPECT_EQ(experiment.camera.dropout, 0);
  EXPECT_EQ(experiment.camera.frame_loss, 0);
}

TEST(TwinExperiment, TakesTheNoiseOfACameraAsMeasured) {
  report::TwinFacts facts = factsOf(kText);
  facts.experiment.camera.tracker = Tracker::kCamera;
  const TwinExperiment twin = twinExperimentOf(facts);

  EXPECT_EQ(twin.experiment.camera.tracker, Tracker::kSimPoses);
  EXPECT_EQ(twin.experiment.camera.position_noise, 0.001);
  EXPECT_THAT(twin.remarks, Contains(HasSubstr("measured in the run: 0.1 cm")));
}

TEST(TwinExperiment, SimulatesRealRobotsAndSaysSo) {
  report::TwinFacts facts = factsOf(kText);
  facts.experiment.robots[0].body = Body::kSerial;
  facts.experiment.robots[0].uid = 7;
  const TwinExperiment twin = twinExperimentOf(facts);

  EXPECT_EQ(twin.experiment.robots[0].body, Body::kSim);
  EXPECT_EQ(twin.experiment.robots[0].uid, 0U);
  EXPECT_THAT(twin.remarks, Contains(HasSubstr("Real robots: 1.")));
}

TEST(TwinExperiment, SaysWhatItDoesNotRepeat) {
  report::TwinFacts facts = factsOf(kText);
  facts.first_poses.erase(2);
  facts.marks = 3;
  facts.ended = false;
  const TwinExperiment twin = twinExperimentOf(facts);

  EXPECT_FALSE(twin.experiment.robots[0].start.has_value());
  EXPECT_THAT(twin.remarks, ElementsAre(HasSubstr("not at the recorded places"),
                                        HasSubstr("has 3 marks"), HasSubstr("no END event")));
}

TEST(TwinExperiment, RepeatsTheScriptWhereARecordedStepIsTooShortForAFile) {
  report::TwinFacts facts = factsOf(kText);
  facts.steps[2].at = 10.255;
  const TwinExperiment twin = twinExperimentOf(facts);

  EXPECT_EQ(twin.experiment.light.steps.size(), 2U);
  EXPECT_TRUE(twin.experiment.light.repeat);
  EXPECT_THAT(twin.remarks, ElementsAre(HasSubstr("which ones the run showed is not known")));
  EXPECT_NO_THROW(static_cast<void>(parseExperiment(writeExperiment(twin.experiment), "twin")));
}

TEST(TwinExperiment, WritesTheFramesAsTheSimulatorReadsThem) {
  const std::string text = framesText({{0.02, {}}, {0.0612345, {2, 7}}});
  const auto frames = parseRecordedFrames(text, "frames.csv");

  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].offset_us, 20'000);
  EXPECT_THAT(frames[0].missing, IsEmpty());
  EXPECT_EQ(frames[1].offset_us, 61'234);
  EXPECT_THAT(frames[1].missing, ElementsAre(2, 7));
}

}  // namespace
}  // namespace lab::runner::campaign::twin_experiment_test
