// `lab calibrate projector` with a simulated projector and camera, whose true parameters are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/calibration/camera_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "light/optics/simulated_camera.hpp"
#include "light/optics/simulated_projector.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using optics::Place;
using testing::HasSubstr;

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

constexpr const char* kExperiment = R"(
fileversion = 1
name = "bent"
seed = 5
duration_s = 2
program = "still"
[[robots]]
id = 1
x_cm = 90
y_cm = 25
theta_deg = 0
[programs.still]
model = "stand"
[projector]
keystone_percent = 15
barrel_percent = 8
sheet_cm = 5
[camera]
tracker = "camera"
width_px = 640
height_px = 360
fps = 20
)";

optics::ProjectorModel truth() {
  return optics::simulatedProjector(kWidth, kHeight, 1920, 1080, {0.15, 0.08, 0, 0});
}

/// Root mean square over the arena of the distance between the place where the calibration puts a
/// projector pixel and the place where its light falls [m].
double trueError(const ProjectorCalibration& calibration) {
  const optics::ProjectorModel assumed = calibration.model();
  double sum = 0;
  int count = 0;
  for (int j = 0; j <= 9; ++j) {
    for (int i = 0; i <= 12; ++i) {
      const Place place{kWidth * i / 12, kHeight * j / 9};
      const Place wanted = assumed.placeOf(truth().pixelOf(place)).value();
      sum += std::pow(wanted.x - place.x, 2) + std::pow(wanted.y - place.y, 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

class CalibrateProjector : public testing::Test {
 protected:
  CalibrateProjector() { std::ofstream(file()) << kExperiment; }

  [[nodiscard]] fs::path file() const { return folder_.path() / "bent.toml"; }
  [[nodiscard]] fs::path out() const { return folder_.path() / "projector.json"; }

  Finished calibrate(const std::string& more = "") {
    return run("lab calibrate projector " + file().string() + " --virtual-time --frames 2 --out " +
                   out().string() + " --runs " + (folder_.path() / "runs").string() + " " + more,
               std::chrono::seconds(240));
  }

  TemporaryFolder folder_;
};

TEST_F(CalibrateProjector, FindsTheLensAndItsAccuracy) {
  // A camera calibration that is wrong by about 0.2 mm, and whose file says so.
  CameraCalibration camera;
  camera.camera = optics::simulatedCamera(640, 360, kWidth, kHeight);
  const optics::CameraModel real(camera.camera);
  camera.camera.fx *= 1.0004;
  camera.camera.fy *= 1.0003;
  camera.camera.translation[0] += 1e-4;
  const optics::CameraModel assumed(camera.camera);
  double sum = 0;
  int count = 0;
  for (int j = 0; j <= 9; ++j) {
    for (int i = 0; i <= 12; ++i) {
      const Place place{kWidth * i / 12, kHeight * j / 9};
      const Place seen = assumed.toPlane(real.project(place.x, place.y, 0.05), 0.05).value();
      sum += std::pow(seen.x - place.x, 2) + std::pow(seen.y - place.y, 2);
      ++count;
    }
  }
  camera.residual = std::sqrt(sum / count);
  ASSERT_NEAR(*camera.residual, 2e-4, 1e-4);
  std::ofstream(folder_.path() / "camera.json") << cameraFileText(camera);
  const Finished done = calibrate("--set camera.calibration=\\\"camera.json\\\"");
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const ProjectorCalibration found = readProjectorFile(out());
  const double error = trueError(found);
  std::printf("claimed %.4f mm, true %.4f mm\n", *found.accuracy * 1e3, error * 1e3);
  EXPECT_LT(error, 0.5e-3);
  EXPECT_NEAR(*found.accuracy / error, 1, 0.2);
  EXPECT_TRUE(fs::exists(folder_.path() / "projector-residuals.png"));
  // The residual of the projector's lens is far below the error of the camera.
  EXPECT_LT(*found.residual, 0.1e-3);
}

TEST_F(CalibrateProjector, PutsLightInTheRightPlace) {
  const Finished done = calibrate();
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_LT(trueError(readProjectorFile(out())), 0.05e-3);
  // For a place on the arena, the warp gives the place for which the light that falls there was
  // meant.
  const Experiment experiment =
      loadExperiment(file(), {"projector.calibration=\"projector.json\"", "projector.sheet_cm=0"});
  const optics::ProjectorWarp calibrated(
      activeProjectorCalibration(experiment, folder_.path(), 1920, 1080).model, truth());
  const optics::ProjectorWarp before(optics::ProjectorModel(kWidth, kHeight, 1920, 1080), truth());
  const Place edge{0.9, 0.25};
  const auto off = [&](const optics::ProjectorWarp& warp) {
    const Place source = warp.source(edge).value();
    return std::hypot(source.x - edge.x, source.y - edge.y);
  };
  EXPECT_GT(off(before), 0.01);
  EXPECT_LT(off(calibrated), 0.1e-3);
  // lab check accepts the file and reports errors of others.
  const std::string check = "lab check " + file().string() + " --set projector.calibration=";
  EXPECT_EQ(run(check + "\\\"projector.json\\\"").exit_code, 0);
  EXPECT_THAT(run(check + "\\\"none.json\\\"").output, HasSubstr("none.json: cannot be read"));
  EXPECT_THAT(run(check + "\\\"projector.json\\\" --set projector.width_px=1280").output,
              HasSubstr("expected 1280 x 1080"));
}

TEST_F(CalibrateProjector, RefusesTheBareFloorWithAFix) {
  const Finished floor = calibrate("--set projector.sheet_cm=0");
  EXPECT_EQ(floor.exit_code, 2) << floor.output;
  EXPECT_THAT(floor.output, HasSubstr("--projector-cm x,y,z"));
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(CalibrateProjector, RefusesAPictureThatLeavesCornersDark) {
  const Finished dark = calibrate("--set projector.offset_x_cm=6");
  EXPECT_EQ(dark.exit_code, 1) << dark.output;
  EXPECT_THAT(dark.output, HasSubstr("does not reach the arena's corner"));
  EXPECT_FALSE(fs::exists(out()));
}

}  // namespace
}  // namespace lab::system_test
