/// Pictures in which caps and floor saturate the camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/tracker_svc/detector/scattered_robots.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::detector {
namespace {

struct DetectedScene {
  int width;    // [px]
  int height;   // [px]
  double gain;  // [1] of white paint: 1.15 saturates the camera
  double blur;  // [px]
};

sim::PainterSettings settingsOf(const DetectedScene& look) {
  sim::PainterSettings settings;
  settings.camera = optics::simulatedCamera(look.width, look.height, 1.20, 0.90);
  settings.gain = look.gain;
  settings.imaging.blur = look.blur;
  return settings;
}

std::vector<Detection> detect(const sim::PainterSettings& settings,
                              const std::vector<sim::PaintedRobot>& robots) {
  light::Field field;
  field.layers = {{.kind = light::LayerKind::kUniform, .intensity = 1}};
  sim::CameraPainter painter(settings);
  painter.setLight(field);
  optics::GreyImage image(settings.camera.width, settings.camera.height);
  painter.paint(robots, 0, image.pixels);
  Detector detector(optics::CameraModel(settings.camera), settings.cap, settings.imaging);
  return detector.search(image.view());
}

std::string nameOf(const DetectedScene& look) {
  return std::to_string(look.width) + " x " + std::to_string(look.height) + ", gain " +
         std::to_string(look.gain) + ", blur " + std::to_string(look.blur);
}

TEST(Overexposed, EveryCapIsFoundAtItsPlace) {
  constexpr double kSame = 0.0005;  // [m]
  constexpr double kTurned = 0.02;  // [rad]
  for (const DetectedScene& look :
       {DetectedScene{640, 480, 1.5, 1.5}, DetectedScene{640, 480, 2, 0.75},
        DetectedScene{640, 480, 2, 1.5}, DetectedScene{960, 540, 2, 1},
        DetectedScene{1280, 720, 2, 2}}) {
    const std::vector<sim::PaintedRobot> robots = scatteredRobots(40, 5);
    const std::vector<Detection> seen = detect(settingsOf(look), robots);
    for (const sim::PaintedRobot& robot : robots) {
      const auto isIt = [&](const Detection& cap) {
        return std::hypot(cap.x - robot.x, cap.y - robot.y) < kSame &&
               std::abs(std::remainder(cap.theta - robot.theta, 2 * std::numbers::pi)) < kTurned;
      };
      EXPECT_EQ(std::ranges::count_if(seen, isIt), 1)
          << nameOf(look) << ": " << robot.x << ", " << robot.y;
    }
    EXPECT_EQ(seen.size(), 40U) << nameOf(look);
  }
}

// The floor saturates as a cap would, so the missing rim is not visible.
TEST(Overexposed, DiscsOnTheFloorAreNotDetected) {
  constexpr double kLooksSmaller = 1.03;  // relative to a cap, which is closer to the camera
  for (const DetectedScene& look :
       {DetectedScene{640, 480, 1.5, 0.75}, DetectedScene{1280, 720, 2, 1.5}}) {
    sim::PainterSettings settings = settingsOf(look);
    for (const sim::PaintedRobot& place : scatteredRobots(12, 9)) {
      for (const bool big : {true, false}) {
        const double along =
            kLooksSmaller * (big ? settings.cap.big_offset : settings.cap.small_offset);
        const double radius =
            kLooksSmaller * (big ? settings.cap.big_radius : settings.cap.small_radius);
        settings.discs.push_back({place.x + along * std::cos(place.theta),
                                  place.y + along * std::sin(place.theta), radius, 0.07});
      }
    }
    EXPECT_TRUE(detect(settings, {}).empty()) << nameOf(look);
  }
}

}  // namespace
}  // namespace lab::detector
