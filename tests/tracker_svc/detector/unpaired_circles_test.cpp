/// Caps of which the search finds only one circle: the other one is in the dark, crossed by a light
/// edge, or under a reflection.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/tracker_svc/detector/scattered_robots.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/detector/cap_check.hpp"

namespace lab::detector::detector_lone_test {
namespace {

using light::Layer;
using light::LayerKind;

struct Scene {
  sim::PainterSettings settings;
  std::vector<sim::PaintedRobot> robots;
  light::Field field;

  Scene(int count, int rows, std::uint64_t seed, double light) {
    settings.camera = optics::simulatedCamera(rows * 16 / 9, rows, 1.20, 0.90);
    settings.seed = seed;
    field.layers = {{.kind = LayerKind::kUniform, .intensity = light}};
    robots = scatteredRobots(count, seed);
  }

  [[nodiscard]] optics::GreyImage paint() const {
    sim::CameraPainter painter(settings);
    painter.setLight(field);
    optics::GreyImage image(settings.camera.width, settings.camera.height);
    painter.paint(robots, 0, image.pixels);
    return image;
  }

  /// Number of robots found; other detections are errors.
  [[nodiscard]] int found() const {
    Detector detector(optics::CameraModel(settings.camera), settings.cap, settings.imaging);
    const optics::GreyImage image = paint();
    int found = 0;
    for (const Detection& seen : detector.search(image.view())) {
      bool right = false;
      for (const sim::PaintedRobot& robot : robots) {
        right = right ||
                (std::hypot(seen.x - robot.x, seen.y - robot.y) < 0.001 &&
                 std::abs(std::remainder(seen.theta - robot.theta, 2 * std::numbers::pi)) < 0.05);
      }
      EXPECT_TRUE(right) << seen.x << " " << seen.y;
      found += right ? 1 : 0;
    }
    return found;
  }
};

TEST(LoneCircle, IsPairedWithACircleAcrossALightEdge) {
  int found = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    Scene scene(40, 720, seed, 0.12);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> away(0, 0.02);
    std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
    for (const sim::PaintedRobot& robot : scene.robots) {
      const double r = away(random);
      const double to = angle(random);
      scene.field.layers.push_back({.kind = LayerKind::kDisk,
                                    .x = robot.x + r * std::cos(to),
                                    .y = robot.y + r * std::sin(to),
                                    .size = 0.03,
                                    .softness = 0.001,
                                    .intensity = 1});
    }
    found += scene.found();
  }
  EXPECT_EQ(found, 240);
}

TEST(LoneCircle, IsPairedWithACircleInTheDark) {
  int found = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene scene(40, 720, seed, 0.02);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> x(0, 1.2);
    std::uniform_real_distribution<double> y(0, 0.9);
    for (int i = 0; i < 20; ++i) {
      scene.field.layers.push_back({.kind = LayerKind::kDisk,
                                    .x = x(random),
                                    .y = y(random),
                                    .size = 0.1,
                                    .softness = 0.001,
                                    .intensity = 1});
    }
    found += scene.found();
  }
  EXPECT_GE(found, 119);  // both circles of one robot are crossed by an edge and half in the dark
}

TEST(LoneCircle, IsSearchedForALimitedTime) {
  // A thousand black discs without partners and without caps.
  Scene scene(0, 720, 1, 1);
  for (double x = 0.03; x < 1.18; x += 0.03) {
    for (double y = 0.03; y < 0.88; y += 0.03) {
      scene.settings.discs.push_back({x, y, 0.0058, 0.07});
    }
  }
  EXPECT_EQ(scene.found(), 0);
}

TEST(Black, MayBeAnyBlackLevelOfTheCamera) {
  for (const double black : {0.0, 8.0, 16.0, 24.0}) {
    Scene scene(40, 720, 5, 0);
    scene.settings.imaging.black = black;
    EXPECT_EQ(scene.found(), 40) << black;
  }
}

TEST(LoneCircle, IsPairedWithACircleUnderGlare) {
  int found = 0;
  for (const double strength : {0.2, 0.3, 0.4}) {
    Scene scene(8, 720, 7, 0.35);
    for (std::size_t i = 0; i < scene.robots.size(); ++i) {
      const sim::PaintedRobot& robot = scene.robots[i];
      const double offset =
          i % 2 == 0 ? scene.settings.cap.big_offset : scene.settings.cap.small_offset;
      scene.settings.glares.push_back({robot.x + offset * std::cos(robot.theta),
                                       robot.y + offset * std::sin(robot.theta), 0.012, strength});
    }
    found += scene.found();
  }
  EXPECT_EQ(found, 24);
}

// Contrasts must be computed with the light of the accepted fit, not with that of the last one
// tried.
TEST(LightEdges, AreEvaluatedWithTheAcceptedFit) {
  struct Case {
    sim::PaintedRobot robot;
    double x, y, angle;  // of the stripes
  };
  for (const Case& one :
       {Case{{0.982796, 0.609892, 1.576827, 0, 0, 0}, 0.754170, 0.326305, -1.298168},
        Case{{0.469563, 0.515477, -2.148098, 0, 0, 0}, 0.675126, 0.569325, -0.907581},
        Case{{0.360009, 0.464161, -2.144665, 0, 0, 0}, 0.699723, 0.302265, -1.258673},
        Case{{0.704226, 0.778817, 2.164024, 0, 0, 0}, 0.772630, 0.379888, -3.067165}}) {
    Scene scene(0, 720, 1, 0.35);
    scene.robots.push_back(one.robot);
    scene.field.layers.push_back({.kind = LayerKind::kStripes,
                                  .x = one.x,
                                  .y = one.y,
                                  .angle = one.angle,
                                  .size = 0.03,
                                  .inner = 0.5,
                                  .softness = 0.001,
                                  .intensity = 1,
                                  .intensity2 = 0.35});
    EXPECT_EQ(scene.found(), 1) << one.robot.x;
  }
}

TEST(CapCheck, IsReliableInDimLight) {
  const Scene scene(0, 720, 3, 0);
  const optics::GreyImage image = scene.paint();
  const optics::CameraModel model(scene.settings.camera);
  const ScaleMap map(model, scene.settings.cap);
  double squares = 0;
  int count = 0;
  for (double x = 0.1; x < 1.15; x += 0.05) {
    for (double y = 0.1; y < 0.85; y += 0.05) {
      const optics::Pixel at = model.project(x, y, scene.settings.cap.height);
      const double rim = static_cast<double>(rimContrast(
          image.view(), at, map.at(at.x, at.y), scene.settings.cap, scene.settings.imaging));
      squares += rim * rim;
      ++count;
    }
  }
  ASSERT_GT(count, 300);
  // The threshold of 0.05 must be three standard deviations; the estimate itself has an error of 4
  // %.
  EXPECT_LT(std::sqrt(squares / count), 0.05 / 3 * 1.12);
}

}  // namespace
}  // namespace lab::detector::detector_lone_test
