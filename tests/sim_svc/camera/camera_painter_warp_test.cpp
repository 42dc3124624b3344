// The simulated camera with a projector that differs from its calibration, and with a white sheet.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "light/optics/simulated_projector.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim {
namespace {

constexpr int kColumns = 640;
constexpr int kRows = 360;
constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

/// A white sheet at sensor height, where light is specified.
PainterSettings plain() {
  PainterSettings settings;
  settings.camera = optics::simulatedCamera(kColumns, kRows, kWidth, kHeight);
  settings.vignetting = 0;
  settings.unevenness = 0;
  settings.hot_pixels = 0;
  settings.texture = false;
  settings.sheet = optics::kSensorHeight;
  return settings;
}

optics::ProjectorModel nominal() { return {kWidth, kHeight, 1920, 1080}; }

optics::ProjectorWarp bent() {
  return {nominal(), optics::simulatedProjector(kWidth, kHeight, 1920, 1080,
                                                {.keystone = 0.15, .barrel = 0.08})};
}

light::Field disk(double x, double y, double radius) {
  light::Layer layer;
  layer.kind = light::LayerKind::kDisk;
  layer.x = x;
  layer.y = y;
  layer.size = radius;
  layer.intensity = 1;
  return {{layer}, {}, 1};
}

/// Centroid of the light [px].
optics::Pixel middleOfLight(CameraPainter& painter) {
  painter.setLight({});
  const std::vector<float> dark = painter.expose({});
  painter.setLight(disk(0.95, 0.2, 0.01));
  const std::vector<float> lit = painter.expose({});
  double x = 0;
  double y = 0;
  double sum = 0;
  for (int v = 0; v < kRows; ++v) {
    for (int u = 0; u < kColumns; ++u) {
      const auto at = static_cast<std::size_t>(v * kColumns + u);
      const double light = static_cast<double>(lit[at]) - static_cast<double>(dark[at]);
      x += light * u;
      y += light * v;
      sum += light;
    }
  }
  return {x / sum, y / sum};
}

/// The point of the arena on which light falls that is commanded at `commanded`. Inverts
/// warp.source() by fixed-point iteration.
optics::Place whereLightFalls(const optics::ProjectorWarp& warp, const optics::Place& commanded) {
  optics::Place place = commanded;
  for (int i = 0; i < 50; ++i) {
    const optics::Place source = warp.source(place).value();
    place.x += commanded.x - source.x;
    place.y += commanded.y - source.y;
  }
  return place;
}

TEST(CameraPainterWarp, ADiskIsVisibleWhereItsLightFalls) {
  PainterSettings settings = plain();
  const optics::CameraModel camera(settings.camera);
  for (const bool straight : {true, false}) {
    if (!straight) settings.warp = bent();
    CameraPainter painter(settings);
    const optics::Place place = whereLightFalls(settings.warp, {0.95, 0.2});
    const optics::Pixel expected = camera.project(place.x, place.y, optics::kSensorHeight);
    const optics::Pixel seen = middleOfLight(painter);
    // The distortion of the disk's outline moves its centroid by about 0.01 px.
    EXPECT_NEAR(seen.x, expected.x, straight ? 0.01 : 0.03);
    EXPECT_NEAR(seen.y, expected.y, straight ? 0.01 : 0.03);
  }
  const optics::Place place = whereLightFalls(bent(), {0.95, 0.2});
  EXPECT_GT(std::hypot(place.x - 0.95, place.y - 0.2), 0.02);
}

TEST(CameraPainterWarp, IsDarkOutsideTheProjectorsPicture) {
  PainterSettings settings = plain();
  settings.warp = {nominal(),
                   optics::simulatedProjector(kWidth, kHeight, 1920, 1080, {.offset_x = 0.1})};
  CameraPainter painter(settings);
  painter.setLight({{light::Layer{.intensity = 1}}, {}, 1});
  const std::vector<float> seen = painter.expose({});
  const optics::CameraModel camera(settings.camera);
  const auto at = [&](double x, double y) {
    const optics::Pixel pixel = camera.project(x, y, optics::kSensorHeight);
    return seen[static_cast<std::size_t>(std::lround(pixel.y) * kColumns + std::lround(pixel.x))];
  };
  EXPECT_LT(at(0.05, 0.45), 20);
  EXPECT_GT(at(0.15, 0.45), 180);
  EXPECT_GT(at(1.15, 0.45), 180);
}

TEST(CameraPainterWarp, TheSheetHidesTheRobots) {
  const PainterSettings settings = plain();
  CameraPainter painter(settings);
  painter.setLight({{light::Layer{.intensity = 0.5}}, {}, 1});
  const std::vector<PaintedRobot> robots = {{0.5, 0.5, 0, 0, 0, 0}};
  EXPECT_EQ(painter.expose(robots), painter.expose({}));
}

}  // namespace
}  // namespace lab::sim
