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

Experiment filmed(FilmCodec codec, int width, int height, double fps) {
  Experiment experiment = painted(2, fps);
  experiment.camera.source = "/dev/video0";
  experiment.camera.film.record = true;
  experiment.camera.film.codec = codec;
  experiment.camera.width = width;
  experiment.camera.height = height;
  return experiment;
}

/// The table of docs/films.md: 33, 5.1 and 9.0 ms for a frame of 1920 x 1080.
TEST(ExperimentLoad, HasTheEncoderOfAFilm) {
  EXPECT_NEAR(loadOf(filmed(FilmCodec::kFfv1, 1920, 1080, 30), "ffmpeg"), 0.99, 1e-9);
  EXPECT_NEAR(loadOf(filmed(FilmCodec::kFfvhuff, 1920, 1080, 60), "ffmpeg"), 0.306, 1e-9);
  EXPECT_NEAR(loadOf(filmed(FilmCodec::kH264, 1920, 1080, 10), "ffmpeg"), 0.09, 1e-9);
  // A quarter of the pixels.
  EXPECT_NEAR(loadOf(filmed(FilmCodec::kFfv1, 960, 540, 40), "ffmpeg"), 0.33, 1e-9);
  EXPECT_EQ(loadOf(painted(2, 30), "ffmpeg"), 0);
  Experiment posed = filmed(FilmCodec::kFfv1, 1920, 1080, 30);
  posed.camera.tracker = Tracker::kSimPoses;
  EXPECT_EQ(loadOf(posed, "ffmpeg"), 0);
}

TEST(ExperimentLoad, HasAnEncoderForEachCamera) {
  Experiment experiment = filmed(FilmCodec::kFfvhuff, 1920, 1080, 100);
  experiment.cameras.resize(2);
  experiment.cameras[0].name = "left";
  experiment.cameras[1].name = "right";
  experiment.cameras[1].height = 540;
  EXPECT_NEAR(loadOf(experiment, "ffmpeg of left"), 0.51, 1e-9);
  EXPECT_NEAR(loadOf(experiment, "ffmpeg of right"), 0.255, 1e-9);
}

TEST(ExperimentLoad, KnowsTheThreadsOfAnEncoder) {
  Experiment experiment = filmed(FilmCodec::kFfv1, 1920, 1080, 60);
  EXPECT_THAT(loadProblem(experiment, 8),
              AllOf(StartsWith("needs about 2.0 cores for ffmpeg in real time, which can use only "
                               "one (camera.record_threads): ffmpeg 1.98, "),
                    HasSubstr("set camera.record_codec = \"ffvhuff\"")));
  experiment.camera.film.threads = 2;
  EXPECT_THAT(loadProblem(experiment, 8), IsEmpty());
  experiment.camera.film.threads = 16;
  experiment.camera.fps = 125;
  EXPECT_THAT(loadProblem(experiment, 8), HasSubstr("which can use only 4 (camera."));
  experiment.camera.film.codec = FilmCodec::kH264;
  EXPECT_THAT(loadProblem(experiment, 8), IsEmpty());
  // The sum of all processes.
  EXPECT_THAT(loadProblem(experiment, 1), StartsWith("needs about 1.2 of 1 core in real time: "));
  experiment.camera.film.codec = FilmCodec::kFfvhuff;
  experiment.camera.fps = 240;
  EXPECT_THAT(loadProblem(experiment, 1),
              AllOf(HasSubstr("ffmpeg 1.22"), Not(HasSubstr("record_codec"))));
}

TEST(ExperimentLoad, HasTheDashboardWhenItIsOn) {
  const auto loads = expectedLoad(small(), true);
  const auto found = std::ranges::find(loads, "dashboard", &ProcessLoad::process);
  ASSERT_NE(found, loads.end());
  EXPECT_EQ(found->cores, 0.03);
  EXPECT_EQ(loadOf(small(), "dashboard"), 0);
  EXPECT_THAT(loadProblem(painted(60, 200), 2, true), HasSubstr(", dashboard 0.03"));
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
