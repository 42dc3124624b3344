#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "common/camera_file.hpp"
#include "common/experiment_file.hpp"
#include "common/random.hpp"
#include "tests/common/temporary_folder.hpp"
#include "light/image.hpp"
#include "optics/simulated_camera.hpp"
#include "runner/commands.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kFrames = 8;
constexpr int kRobots = 20;

/// Robots anywhere in the arena, apart from each other.
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

/// A film of robots under an uneven light, and where the corners are in it.
class CalibrateCamera : public testing::Test {
 protected:
  CalibrateCamera() {
    film("film", 1.2);
    const optics::CameraModel model(truth_);
    constexpr double kMarked[] = {0.1, -0.1, -0.1, 0.05, 0.1, 0.1, -0.05, -0.1};  // px off
    constexpr optics::Place kCorners[] = {{0, 0}, {1.2, 0}, {1.2, 0.9}, {0, 0.9}};
    for (std::size_t i = 0; i < 4; ++i) {
      const optics::Pixel at = model.project(kCorners[i].x, kCorners[i].y, 0);
      options_.corners += fmt::format("{:.2f},{:.2f} ", at.x + kMarked[2 * i],
                                      at.y + kMarked[2 * i + 1]);
    }
    options_.source = (folder_ / "film").string();
    options_.out = folder_ / "camera.json";
    options_.corner_px = 0.1;
  }

  void film(const std::string& name, double widest, const optics::Imaging& imaging = {}) {
    fs::create_directory(folder_ / name);
    sim::PainterSettings settings;
    settings.camera = truth_;
    settings.imaging = imaging;
    sim::CameraPainter painter(settings);
    light::Layer dim;
    dim.intensity = 0.6;
    painter.setLight({{dim}, {}, 1});
    Random random(7);
    for (int k = 0; k < kFrames; ++k) {
      optics::GreyImage picture(kWidth, kHeight);
      painter.paint(someRobots(random, widest), k, picture.pixels);
      ASSERT_FALSE(light::writeFile(folder_ / fmt::format("{}/f{:04}.png", name, k),
                                    light::encodePng(kWidth, kHeight, picture.pixels)));
    }
  }

  /// [m] by how much places on the caps' plane are off, root mean square over the arena.
  [[nodiscard]] double errorOf(const optics::CameraParameters& found) const {
    const optics::CameraModel model(found);
    const optics::CameraModel truth(truth_);
    double squares = 0;
    int places = 0;
    for (int i = 0; i <= 12; ++i) {
      for (int j = 0; j <= 9; ++j) {
        const auto seen = model.toPlane(truth.project(0.1 * i, 0.1 * j, 0.05), 0.05);
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
  EXPECT_EQ(found.gamma, 1);
  EXPECT_EQ(found.camera.width, kWidth);
  EXPECT_EQ(found.camera.height, kHeight);

  EXPECT_THAT(problem(), HasSubstr("is there already"));
}

TEST_F(CalibrateCamera, FindsACameraThatEncodesForTheEye) {
  film("webcam", 1.2, {.gamma = 2.2});
  options_.source = (folder_ / "webcam").string();
  ASSERT_EQ(calibrateCamera(options_), kDone);
  const CameraCalibration found = readCameraFile(options_.out);
  EXPECT_EQ(found.gamma, 2.2);
  ASSERT_TRUE(found.residual);
  EXPECT_LT(errorOf(found.camera), 2 * *found.residual);
  EXPECT_LT(*found.residual, 0.6e-3);
}

TEST_F(CalibrateCamera, AsksForAPlaceToWriteBeforeItLooksAtTheFilm) {
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

TEST_F(CalibrateCamera, MeasuresHowBlurredThePicturesAre) {
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

TEST_F(CalibrateCamera, RefusesWrongNumbers) {
  options_.spacing_cm = 3.3;  // a tenth too small: no camera fits
  testing::internal::CaptureStdout();
  const ExitCode code = calibrateCamera(options_);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("refused"));
  EXPECT_EQ(code, kFailed);
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(CalibrateCamera, SaysWhatIsWrongWithItsArguments) {
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
