#include "common/experiment/command_line_sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <string_view>

#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kRos = "[gateway]\nros = true\n";
constexpr const char* kPipeline =
    "[camera]\ntracker = \"camera\"\ncamera = \"pipeline\"\ncalibration = \"c.json\"\n";

std::string problemOf(const CommandLineSources& sources, Experiment experiment) {
  try {
    adopt(sources, experiment);
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "none";
}

Experiment withSerialRobot(std::string_view more) {
  return small(more, {"robots[0].body=serial", "robots[0].uid=7"});
}

TEST(CommandLineSources, GiveTheGatewayItsConfiguration) {
  Experiment dut = small(kRos);
  adopt({.dds_configuration = "/my.xml"}, dut);
  EXPECT_EQ(dut.gateway.configuration, "/my.xml");
}

TEST(CommandLineSources, GiveTheCameraItsPipeline) {
  Experiment dut = withSerialRobot(kPipeline);
  EXPECT_THROW(requirePipeline(dut), ExperimentError);

  adopt({.camera_pipeline = "aravissrc ! queue"}, dut);

  EXPECT_EQ(dut.camera.source, "gst:aravissrc ! queue");
  EXPECT_EQ(pipelineOf(dut.camera), "aravissrc ! queue");
  requirePipeline(dut);
}

TEST(CommandLineSources, AreNeverWrittenIntoAFile) {
  Experiment ros = small(kRos);
  const std::string before = writeExperiment(ros);
  adopt({.dds_configuration = "/my.xml"}, ros);
  EXPECT_EQ(writeExperiment(ros), before);

  Experiment camera = withSerialRobot(kPipeline);
  const std::string without = writeExperiment(camera);
  adopt({.camera_pipeline = "aravissrc"}, camera);
  EXPECT_EQ(writeExperiment(camera), without);
  EXPECT_THAT(without, HasSubstr("camera = \"pipeline\""));
}

TEST(CommandLineSources, ThatContradictTheFileAreRefused) {
  EXPECT_THAT(problemOf({.dds_configuration = "/my.xml"}, small()),
              AllOf(HasSubstr("--dds-configuration /my.xml"), HasSubstr("gateway.ros = true")));
  EXPECT_THAT(problemOf({.dds_configuration = "/my.xml"},
                        small(std::string(kRos) + "address = \"192.168.1.5\"\n")),
              AllOf(HasSubstr("--dds-configuration /my.xml: gateway.configuration"),
                    HasSubstr("next to gateway.address")));
  EXPECT_THAT(
      problemOf({.dds_configuration = "/my.xml"}, small(std::string(kRos) + "commands = true\n")),
      HasSubstr("gateway.unsecured_commands"));
  EXPECT_THAT(problemOf({.camera_pipeline = "aravissrc"}, small()),
              AllOf(HasSubstr("--camera-pipeline"), HasSubstr("expected \"pipeline\"")));
}

TEST(CommandLineSources, OfOlderLogsAreStillRead) {
  const std::string text =
      std::string(kSmall) + "[gateway]\nros = true\nconfiguration = \"my.xml\"\n";
  EXPECT_EQ(parseExperiment(text, "a log").gateway.configuration, "my.xml");

  const TemporaryFolder folder;
  std::ofstream(folder / "e.toml") << text;
  EXPECT_THROW(static_cast<void>(loadExperiment(folder / "e.toml")), ExperimentError);
  EXPECT_EQ(loadRecordedExperiment(folder / "e.toml").gateway.configuration, "my.xml");

  std::string camera = writeExperiment(withSerialRobot(kPipeline));
  camera.replace(camera.find("\"pipeline\""), 10, "\"gst:aravissrc ! queue\"");
  std::ofstream(folder / "camera.toml") << camera;
  EXPECT_THROW(static_cast<void>(loadExperiment(folder / "camera.toml")), ExperimentError);
  EXPECT_EQ(loadRecordedExperiment(folder / "camera.toml").camera.source, "gst:aravissrc ! queue");
  EXPECT_THROW(static_cast<void>(
                   parseExperiment(kSmall, "e", {"gateway.configuration=my.xml"}, folder.path())),
               ExperimentError)
      << "the dashboard passes --set of its page";
}

}  // namespace
}  // namespace lab
