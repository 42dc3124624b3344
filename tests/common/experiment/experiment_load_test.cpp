#include "common/experiment/experiment_load.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/experiment/experiment_file.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

Experiment painted(int robots, double fps) {
  Experiment experiment = small();
  experiment.robots.assign(static_cast<std::size_t>(robots), experiment.robots.front());
  experiment.camera.tracker = Tracker::kCamera;
  experiment.camera.fps = fps;
  experiment.camera.width = 1280;
  experiment.camera.height = 720;
  return experiment;
}

double loadOf(const Experiment& experiment, const std::string& process) {
  const auto loads = expectedLoad(experiment);
  const auto found = std::ranges::find(loads, process, &ProcessLoad::process);
  return found == loads.end() ? 0 : found->cores;
}

/// The cases of tests/benchmarks/robots_per_core.py, with the cores that it measured.
TEST(ExperimentLoad, ReproducesWhatWasMeasured) {
  EXPECT_NEAR(loadOf(painted(20, 30), "sim_svc"), 0.202, 0.02);
  EXPECT_NEAR(loadOf(painted(2, 30), "sim_svc"), 0.059, 0.006);
  EXPECT_NEAR(loadOf(painted(20, 30), "tracker_svc"), 0.013, 0.002);
  Experiment crowd = small();
  crowd.robots.assign(100, crowd.robots.front());
  crowd.camera.fps = 100;
  EXPECT_NEAR(loadOf(crowd, "analyzer"), 0.127, 0.01);
  EXPECT_NEAR(loadOf(crowd, "sim_svc"), 0.013, 0.002);
  EXPECT_EQ(loadOf(crowd, "tracker_svc"), 0);
  EXPECT_EQ(loadOf(crowd, "dds_gateway"), 0);
}

TEST(ExperimentLoad, GrowsWithThePixelsOfTheCamera) {
  Experiment experiment = painted(1, 30);
  const double once = loadOf(experiment, "tracker_svc");
  experiment.camera.width *= 2;
  experiment.camera.height *= 2;
  EXPECT_GT(loadOf(experiment, "tracker_svc"), 2 * once);
}

TEST(ExperimentLoad, CountsThePicturesOfAllCameras) {
  Experiment one = painted(1, 30);
  one.robots.clear();
  Experiment four = one;
  four.cameras.resize(4);
  // Without its fixed part, 0.0047 cores.
  EXPECT_NEAR(loadOf(four, "tracker_svc") - 0.0047, 4 * (loadOf(one, "tracker_svc") - 0.0047),
              1e-6);
}

TEST(ExperimentLoad, SaysWhichProcessesNeedMoreThanThisMachineHas) {
  EXPECT_THAT(loadProblem(small(), 2), IsEmpty());
  EXPECT_THAT(loadProblem(painted(40, 30), 2), IsEmpty());
  EXPECT_THAT(loadProblem(painted(60, 200), 2),
              AllOf(StartsWith("needs about 2.9 of 2 cores in real time: sim_svc 2.69, "),
                    HasSubstr("tracker_svc 0.09"), HasSubstr("lower camera.fps")));
  EXPECT_THAT(loadProblem(painted(60, 200), 0), HasSubstr("which can use only one"));
}

// A lab at the limit of an experiment file. Simulated poses cost little; painting does not.
TEST(ExperimentLoad, TwoCoresCarry250RobotsAt50FramesWithoutPictures) {
  EXPECT_THAT(loadProblem(painted(250, 50), 2),
              AllOf(StartsWith("needs about 3.6 of 2 cores in real time: sim_svc 3.16, analyzer "),
                    HasSubstr("use --virtual-time")));
  Experiment posed = painted(250, 50);
  posed.camera.tracker = Tracker::kSimPoses;
  EXPECT_THAT(loadProblem(posed, 2), IsEmpty());
  EXPECT_NEAR(loadOf(posed, "analyzer"), 0.30, 0.03);
}

TEST(ExperimentLoad, KnowsThatAProcessCanUseOnlyOneCore) {
  EXPECT_THAT(loadProblem(painted(60, 100), 8),
              StartsWith("needs about 1.4 cores for sim_svc in real time, which can use only one"));
}

TEST(ExperimentLoad, LeavesOutServicesOnOtherHosts) {
  Experiment experiment = painted(60, 200);
  experiment.services["sim_svc"].host = "pi";
  EXPECT_THAT(loadProblem(experiment, 2), Not(HasSubstr("sim_svc")));
}

}  // namespace
}  // namespace lab
