#include "runner/runs/run_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/experiment_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class PreparedRunTest : public testing::Test {
 protected:
  PreparedRun prepare(const Experiment& experiment) {
    return prepareRun(experiment, folder_.path(), folder_ / "runs", 1'750'000'000'000'000);
  }

  /// The refusal; no folder of a run may exist then.
  std::string problemOf(const Experiment& experiment) {
    try {
      static_cast<void>(prepare(experiment));
    } catch (const std::exception& error) {
      EXPECT_FALSE(fs::exists(folder_ / "runs"));
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
};

TEST_F(PreparedRunTest, StoresTheMappingAndTheConfigurationOfTheCommandLine) {
  const std::string mapping = "fileversion = 1\n[[rules]]\ntopic = \"/lab/.*\"\nallow = false\n";
  support::writeFile(folder_ / "m.toml", mapping);
  support::writeFile(folder_ / "c.xml", "<CycloneDDS></CycloneDDS>");
  Experiment experiment = small("[gateway]\nros = true\nmapping = \"m.toml\"\n");
  experiment.gateway.configuration = folder_ / "c.xml";

  const PreparedRun dut = prepare(experiment);

  EXPECT_EQ(support::readFile(dut.directory / "gateway/mapping.toml"), mapping);
  EXPECT_EQ(dut.experiment.gateway.configuration, "gateway/cyclonedds.xml");
  EXPECT_EQ(support::readFile(dut.directory / "gateway/cyclonedds.xml"),
            "<CycloneDDS></CycloneDDS>");
  const Experiment read = loadExperiment(dut.directory / "experiment.toml");
  EXPECT_EQ(read.gateway.mapping, "gateway/mapping.toml");
  EXPECT_EQ(read.gateway.configuration, "");
}

TEST_F(PreparedRunTest, CopiesNoFileThatIsNotWhatItShouldBe) {
  support::writeFile(folder_ / "secret", "password = \"x\"\n");
  Experiment mapped = small("[gateway]\nros = true\nmapping = \"secret\"\n");
  EXPECT_THAT(problemOf(mapped), HasSubstr("secret:1: password: found an unknown key"));
  mapped.gateway.mapping = "/proc/self/environ";
  EXPECT_THAT(problemOf(mapped), HasSubstr("found a file of the kernel"));

  Experiment replayed = small();
  replayed.robots[0].body = Body::kReplay;
  replayed.robots[0].log = "secret";
  EXPECT_THAT(problemOf(replayed), AllOf(HasSubstr("secret"), HasSubstr("there is no log")));

  Experiment driven = small();
  driven.hardware.motors = "secret";
  EXPECT_THAT(problemOf(driven), HasSubstr("found no [[robots]]"));
}

TEST_F(PreparedRunTest, WaitsForNoPipe) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  Experiment experiment = small();
  experiment.hardware.motors = "pipe";
  EXPECT_THAT(problemOf(experiment), HasSubstr("pipe: found a pipe, expected a calibration"));
  const auto checked = [&]() -> std::string {
    try {
      checkFiles(experiment, folder_.path());
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(checked(), StartsWith("robot.motors: ")) << "lab check names the key";
  experiment = small();
  experiment.camera.frames = "pipe";
  EXPECT_THAT(problemOf(experiment), HasSubstr("pipe: found a pipe"));
  EXPECT_THAT(checked(), StartsWith("camera.frames: "));
  experiment = small("[gateway]\nros = true\nmapping = \"pipe\"\n");
  EXPECT_THROW(checkFiles(experiment, folder_.path()), std::exception);
  EXPECT_NO_THROW(checkFiles(small(), folder_.path()));
  experiment = small();
  experiment.robots[0].body = Body::kReplay;
  experiment.robots[0].log = "pipe";
  EXPECT_THAT(problemOf(experiment), HasSubstr("there is no log"));
  experiment = small();
  experiment.projector.light_calibration = "pipe";
  EXPECT_THAT(problemOf(experiment), HasSubstr("pipe: found a pipe"));
  experiment = small();
  experiment.projector.calibration = "pipe";
  EXPECT_THAT(problemOf(experiment), HasSubstr("pipe: found a pipe"));
}

// Checks read all images and recordings; lab run has made them before it starts agents.
TEST_F(PreparedRunTest, IsCheckedOnce) {
  Experiment experiment = small();
  experiment.robots[0].body = Body::kSerial;
  experiment.serial.ports = "/dev/null";
  EXPECT_THAT(problemOf(experiment), StartsWith("serial.ports: "));

  const PreparedRun dut = prepareCheckedRun(experiment, folder_.path(), folder_ / "runs", 0);

  EXPECT_TRUE(fs::exists(dut.directory / files::kExperiment));
}

TEST(MakeRunDirectory, NamesTheOptionThatChoosesAnotherFolder) {
  const TemporaryFolder folder;
  support::writeFile(folder / "file", "x");
  const auto problemWith = [&](auto... option) -> std::string {
    try {
      static_cast<void>(makeRunDirectory(folder / "file", "abp", 0, option...));
    } catch (const UserError& error) {
      return error.what();
    }
    return "made";
  };
  EXPECT_EQ(problemWith(), "cannot make a folder in " + (folder / "file").string() +
                               ": Not a directory; choose another with --runs");
  EXPECT_THAT(problemWith("--out"), testing::EndsWith("; choose another with --out"));
}

}  // namespace
}  // namespace lab::runner
