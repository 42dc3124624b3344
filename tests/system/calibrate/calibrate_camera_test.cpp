/// `lab calibrate camera EXPERIMENT.toml`: starts and films a lab and calibrates its camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/calibration/camera_file.hpp"
#include "light/optics/simulated_camera.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kTwelveRobots = R"(
fileversion = 1
name = "twelve"
seed = 5
duration_s = 60
program = "abp"
[[robots]]
id = 1
count = 12
[programs.abp]
model = "abp"
v_cm_s = 10
epsilon_s = 0.3
eta_rad_s = 4
[reversal]
on = "any"
distance_cm = 10
[camera]
tracker = "camera"
camera = "sim"
width_px = 1280
height_px = 720
)";

class CalibrateCamera : public testing::Test {
 protected:
  CalibrateCamera() { std::ofstream(file()) << kTwelveRobots; }

  [[nodiscard]] fs::path file() const { return folder_.path() / "twelve.toml"; }
  [[nodiscard]] fs::path out() const { return folder_.path() / "camera.json"; }

  Finished calibrate(const std::string& more) {
    return run("lab calibrate camera " + file().string() + " --out " + out().string() + " --runs " +
               runs().string() + " " + more);
  }
  [[nodiscard]] fs::path runs() const { return folder_.path() / "runs"; }

 private:
  TemporaryFolder folder_;
};

TEST_F(CalibrateCamera, FindsTheCameraOfALabThatItStarts) {
  const Finished finished = calibrate("--virtual-time --film-s 30");
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("mm"));
  const CameraCalibration found = readCameraFile(out());
  ASSERT_TRUE(found.residual);
  EXPECT_LT(*found.residual, 1.5e-3);
  const optics::CameraModel model(found.camera);
  const optics::CameraModel truth(optics::simulatedCamera(1280, 720, 1.2, 0.9));
  double squares = 0;
  int places = 0;
  for (int i = 0; i <= 12; ++i) {
    for (int j = 0; j <= 9; ++j) {
      const auto seen = model.toPlane(truth.project(0.1 * i, 0.1 * j, 0.05), 0.05);
      ASSERT_TRUE(seen);
      squares += std::pow(seen->x - 0.1 * i, 2) + std::pow(seen->y - 0.1 * j, 2);
      ++places;
    }
  }
  const double rms = std::sqrt(squares / places);
  RecordProperty("rms_um", std::to_string(1e6 * rms));
  RecordProperty("claimed_um", std::to_string(1e6 * *found.residual));
  EXPECT_LT(rms, 2 * *found.residual);
  EXPECT_EQ(found.camera.width, 1280);

  // The film that remains has times, so it can be tracked.
  const Finished film = run("sh -c 'cat " + runs().string() + "/*/calibration/film/frames.csv'");
  EXPECT_THAT(film.output, HasSubstr("frame,t_s\n0,0.000000\n1,0.5"));
  EXPECT_THAT(film.output, HasSubstr("\n59,29.5"));

  const Finished again = calibrate("--virtual-time");
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.output, HasSubstr("is there already"));
}

TEST_F(CalibrateCamera, RefusesAFilmOfRobotsAtRest) {
  const Finished finished = calibrate(
      "--virtual-time --film-s 5 --set programs.abp.v_cm_s=0 "
      "--set programs.abp.eta_rad_s=0");
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("refused"));
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(CalibrateCamera, ReportsAMissingCamera) {
  const Finished finished = run("lab calibrate camera " + experiment("swarm").string() +
                                " --virtual-time --out " + out().string());
  EXPECT_EQ(finished.exit_code, 2) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("camera.tracker"));
}

}  // namespace
}  // namespace lab::system_test
