#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/math/random.hpp"
#include "light/field/image.hpp"
#include "light/optics/simulated_camera.hpp"
#include "runner/calibrate/calibrate_commands.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kFrames = 8;
constexpr int kRobots = 20;

/// Robots at random places in the arena, with a minimum distance.
std::vector<sim::PaintedRobot> someRobots(Random& random, double widest) {
  std::vector<sim::PaintedRobot> robots;
  while (static_cast<int>(robots.size()) < kRobots) {
    const double x = 0.04 + (widest - 0.08) * random.uniform();
    const double y = 0.04 + 0.82 * random.uniform();
    const bool apart = std::ranges::none_of(robots, [&](const sim::PaintedRobot& other) {
      return std::hypot(x - other.x, y - other.y) < 0.08;
    });
    if (apart) robots.push_back({x, y, 2 * std::numbers::pi * random.uniform(), 0, 0, 0});
  }
  return robots;
}

/// A film of robots and the marked corners of the arena in it.
class CalibrateCamera : public testing::Test {
 protected:
  CalibrateCamera() {
    film("film", 1.2);
    const optics::CameraModel model(truth_);
    constexpr double kMarked[] = {0.1, -0.1, -0.1,  0.05,
                                  0.1, 0.1,  -0.05, -0.1};  // [px] error of the marked corners
    constexpr optics::Place kCorners[] = {{0, 0}, {1.2, 0}, {1.2, 0.9}, {0, 0.9}};
    for (std::size_t i = 0; i < 4; ++i) {
      const optics::Pixel at = model.project(kCorners[i].x, kCorners[i].y, 0);
      options_.corners +=
          fmt::format("{:.2f},{:.2f} ", at.x + kMarked[2 * i], at.y + kMarked[2 * i + 1]);
    }
    options_.source = (folder_ / "film").string();
    options_.out = folder_ / "camera.json";
    options_.corner_px = 0.1;
  }

  void film(const std::string& name, double widest, const optics::Imaging& imaging = {},
            const optics::CapGeometry& cap = {}) {
    fs::create_directory(folder_ / name);
    sim::PainterSettings settings;
    settings.camera = truth_;
    settings.imaging = imaging;
    settings.cap = cap;
    sim::CameraPainter painter(settings);
    light::Layer dim;
    dim.intensity = 0.6;
    painter.setLight({{dim}, {}, 1});
    Random random(7);
    for (int k = 0; k < kFrames; ++k) {
      optics::GreyImage picture(kWidth, kHeight);
      painter.paint(someRobots(random, widest), k, picture.pixels);
      replaceFile(folder_ / fmt::format("{}/f{:04}.png", name, k),
                  light::encodePng(kWidth, kHeight, picture.pixels));
    }
  }

  /// Root mean square error of places on the plane of the caps over the arena [m].
  [[nodiscard]] double errorOf(const optics::CameraParameters& found,
                               double height = optics::CapGeometry{}.height) const {
    const optics::CameraModel model(found);
    const optics::CameraModel truth(truth_);
    double squares = 0;
    int places = 0;
    for (int i = 0; i <= 12; ++i) {
      for (int j = 0; j <= 9; ++j) {
        const auto seen = model.toPlane(truth.project(0.1 * i, 0.1 * j, height), height);
        if (!seen) return INFINITY;
        squares += std::pow(seen->x - 0.1 * i, 2) + std::pow(seen->y - 0.1 * j, 2);
        ++places;
      }
    }
    return std::sqrt(squares / places);
  }

  [[nodiscard]] std::string problem() const {
    try {
      static_cast<void>(calibrateCamera(options_));
    } catch (const UserError& error) {
      return error.what();
    }
    return {};
  }

  TemporaryFolder folder_;
  optics::CameraParameters truth_ = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
  CalibrateCameraOptions options_;
};

TEST_F(CalibrateCamera, FindsTheCameraThatTookTheFilm) {
  ASSERT_EQ(calibrateCamera(options_), kDone);
  const CameraCalibration found = readCameraFile(options_.out);
  ASSERT_TRUE(found.residual);
  const double rms = errorOf(found.camera);
  RecordProperty("rms_um", std::to_string(1e6 * rms));
  RecordProperty("claimed_um", std::to_string(1e6 * *found.residual));
  EXPECT_LT(rms, 2 * *found.residual);
  EXPECT_LT(*found.residual, 0.6e-3);
  ASSERT_TRUE(found.imaging);
  EXPECT_EQ(found.imaging->gamma, 1);
  EXPECT_EQ(found.camera.width, kWidth);
  EXPECT_EQ(found.camera.height, kHeight);

  EXPECT_THAT(problem(), HasSubstr("is there already"));
}

// The folder of a film may come from a stranger.
TEST_F(CalibrateCamera, ShowsControlCharactersOfNamesAsText) {
  options_.source = (folder_ / "film\x1b[2J").string();
  fs::rename(folder_ / "film", options_.source);
  std::ofstream(folder_ / "film\x1b[2J/f0009.png") << "no picture";
  options_.out = folder_ / "camera\x1b[2J.json";
  testing::internal::CaptureStdout();
  ASSERT_EQ(calibrateCamera(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::AllOf(HasSubstr("/film\\x1b[2J/f0009.png: is not a picture"),
                             HasSubstr("/camera\\x1b[2J.json\n"), testing::Not(HasSubstr("\x1b"))));
}

TEST_F(CalibrateCamera, FindsTheGammaOfTheCamera) {
  film("webcam", 1.2, {.gamma = 2.2});
  options_.source = (folder_ / "webcam").string();
  ASSERT_EQ(calibrateCamera(options_), kDone);
  const CameraCalibration found = readCameraFile(options_.out);
  ASSERT_TRUE(found.imaging);
  EXPECT_EQ(found.imaging->gamma, 2.2);
  ASSERT_TRUE(found.residual);
  EXPECT_LT(errorOf(found.camera), 2 * *found.residual);
  EXPECT_LT(*found.residual, 0.6e-3);
}

TEST_F(CalibrateCamera, UsesTheSizesOfOtherCaps) {
  const optics::CapGeometry other{.robot_radius = 0.033,
                                  .cap_radius = 0.031,
                                  .height = 0.04,
                                  .big_radius = 0.0075,
                                  .small_radius = 0.0045,
                                  .big_offset = 0.017,
                                  .small_offset = -0.013};
  film("other", 1.2, {}, other);
  options_.source = (folder_ / "other").string();
  options_.robot_radius_cm = 3.3;
  options_.cap_radius_cm = 3.1;
  options_.cap_height_cm = 4;
  options_.big_radius_cm = 0.75;
  options_.small_radius_cm = 0.45;
  options_.spacing_cm = 3;
  options_.big_offset_cm = 1.7;
  ASSERT_EQ(calibrateCamera(options_), kDone);
  const CameraCalibration found = readCameraFile(options_.out);
  EXPECT_NEAR(found.cap.small_offset, other.small_offset, 1e-12);
  EXPECT_NEAR(found.cap.robot_radius, other.robot_radius, 1e-12);
  ASSERT_TRUE(found.residual);
  EXPECT_LT(errorOf(found.camera, other.height), 2 * *found.residual);
  EXPECT_LT(*found.residual, 0.6e-3);
}

TEST_F(CalibrateCamera, WritesADrawingOfCaps) {
  options_.print_caps = folder_ / "caps.svg";
  ASSERT_EQ(calibrateCamera(options_), kDone);
  std::ifstream stream(options_.print_caps);
  const std::string svg{std::istreambuf_iterator<char>(stream), {}};
  const auto count = [&](const std::string& what) {
    int found = 0;
    for (auto at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("r=\"36\""), 6);
  EXPECT_EQ(count("r=\"9\"/>"), 6);
  EXPECT_EQ(count("r=\"5.5\"/>"), 6);
  EXPECT_THAT(svg, HasSubstr("width=\"210mm\" height=\"297mm\""));
  EXPECT_THAT(problem(), HasSubstr("is there already"));

  options_.cap_radius_cm = 20;  // larger than the paper: one cap on a larger drawing
  options_.force = true;
  ASSERT_EQ(calibrateCamera(options_), kDone);
}

TEST_F(CalibrateCamera, ReportsImpossibleSizesOfCaps) {
  options_.big_radius_cm = 2;
  EXPECT_THAT(problem(), HasSubstr("--cap-radius-cm: found 3.6, expected at least the "
                                   "reach of the circles from the axis, 3.8"));
  options_.big_radius_cm = 0.5;
  EXPECT_THAT(problem(),
              HasSubstr("--small-radius-cm: found 0.55, expected less than the big circle's 0.5"));
  options_.big_radius_cm = 0.9;
  options_.spacing_cm = 1;
  EXPECT_THAT(problem(), HasSubstr("--spacing-cm: found 1, expected at least the sum of both "
                                   "circles' radii, 1.45"));
}

TEST_F(CalibrateCamera, ChecksTheOutputBeforeItReadsTheFilm) {
  options_.source = (folder_ / "there_is_none").string();
  options_.out = folder_ / "nowhere" / "camera.json";
  EXPECT_THAT(problem(), HasSubstr("there is no folder"));
  options_.out = folder_ / "";
  EXPECT_THAT(problem(), HasSubstr("is a folder"));
  options_.out = folder_ / "camera.json";
  EXPECT_THAT(problem(), HasSubstr("there_is_none: no such file"));
  options_.source = "rtsp://camera.local/stream";
  EXPECT_THAT(problem(), HasSubstr("is a network stream, expected a film"));
}

TEST_F(CalibrateCamera, MeasuresTheBlurOfThePictures) {
  for (const double blur : {0.75, 1.8}) {
    const std::string name = fmt::format("blurred_{}", blur);
    film(name, 1.2, {.blur = blur});
    options_.source = (folder_ / name).string();
    options_.out = folder_ / (name + ".json");
    ASSERT_EQ(calibrateCamera(options_), kDone) << blur;
    const CameraCalibration found = readCameraFile(options_.out);
    ASSERT_TRUE(found.imaging) << blur;
    // Measured: 1 % too sharp at 0.75 px, 2 % at 1.8 px.
    EXPECT_NEAR(found.imaging->blur, blur, 0.03 * blur);
    EXPECT_EQ(found.imaging->read_noise, optics::Imaging{}.read_noise);
  }
}

TEST_F(CalibrateCamera, RefusesAFilmOfHalfTheArena) {
  film("half", 0.7);
  options_.source = (folder_ / "half").string();
  testing::internal::CaptureStdout();
  const ExitCode code = calibrateCamera(options_);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("high x"));
  EXPECT_EQ(code, kFailed);
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(CalibrateCamera, RefusesWrongSizesOfTheCap) {
  options_.spacing_cm = 3.3;  // a tenth too small: no camera fits
  testing::internal::CaptureStdout();
  const ExitCode code = calibrateCamera(options_);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("refused"));
  EXPECT_EQ(code, kFailed);
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(CalibrateCamera, ReportsWrongArguments) {
  CalibrateCameraOptions good = options_;
  options_.corners = "1,2 3,4 5,6";
  EXPECT_THAT(problem(), HasSubstr("--corners: found \"1,2 3,4 5,6\", expected four pixels"));
  options_ = good;
  options_.arena_cm = "120";
  EXPECT_THAT(problem(), HasSubstr("--arena-cm: found \"120\""));
  options_ = good;
  options_.source = (folder_ / "no_such_film").string();
  EXPECT_THAT(problem(), HasSubstr("no_such_film"));
}

}  // namespace
}  // namespace lab::runner
