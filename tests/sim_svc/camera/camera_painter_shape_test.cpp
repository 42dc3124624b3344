// Compares positions of painted objects with a reference that traces rays.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/sim_svc/camera/painter_reference.hpp"

namespace lab::sim::camera_painter_shape_test {
namespace {

using reference::Window;

light::Field lit(double intensity) {
  light::Layer layer;
  layer.intensity = intensity;
  return {{layer}, {}, 1};
}

/// A camera without noise and vignetting.
PainterSettings plain(int width = 1280, int height = 720) {
  PainterSettings settings;
  settings.camera = optics::simulatedCamera(width, height, 1.20, 0.90);
  settings.vignetting = 0;
  settings.unevenness = 0;
  settings.hot_pixels = 0;
  settings.texture = false;
  settings.imaging.black = 0;
  // A large white cap, so that only white surrounds the circles even with blur.
  settings.cap.cap_radius = 0.055;
  settings.cap.robot_radius = 0.056;
  return settings;
}

struct Compared {
  double off = 0;    ///< [px] distance between the centres of the big circle
  double worst = 0;  ///< [DN] largest difference of a pixel
};

/// A window that contains only the big circle and the cap around it.
Compared compare(const PainterSettings& settings, const PaintedRobot& robot, int rays = 20) {
  CameraPainter painter(settings);
  painter.setLight(lit(1));
  const optics::CameraModel model(settings.camera);
  const double x = robot.x + settings.cap.big_offset * std::cos(robot.theta);
  const double y = robot.y + settings.cap.big_offset * std::sin(robot.theta);
  optics::PlaneScale scale;
  const optics::Pixel at = model.project(x, y, settings.cap.height, scale);
  const int half = static_cast<int>(std::lround(0.0125 * std::hypot(scale.ux, scale.uy)));
  const Window window{static_cast<int>(std::lround(at.x)) - half,
                      static_cast<int>(std::lround(at.y)) - half, 2 * half + 1, 2 * half + 1};
  const double full = kFullSignal / settings.albedos.floor * (1 + settings.ambient);
  // Motion: the mean over several times.
  constexpr int kInstants = 8;
  const bool moves = robot.vx != 0 || robot.vy != 0 || robot.omega != 0;
  const auto grey = [&](optics::Pixel pixel) {
    const auto place = model.toPlane(pixel, settings.cap.height);
    double sum = 0;
    for (int k = 0; k < (moves ? kInstants : 1); ++k) {
      const double later = moves ? ((k + 0.5) / kInstants - 0.5) * settings.exposure : 0;
      PaintedRobot then = robot;
      then.x += robot.vx * later;
      then.y += robot.vy * later;
      then.theta += robot.omega * later;
      sum += reference::capAlbedo(settings, then, *place);
    }
    return full * sum / (moves ? kInstants : 1);
  };
  const std::vector<double> expected =
      reference::blurred(window, settings.imaging.blur, rays, grey);
  const std::vector<PaintedRobot> robots = {robot};
  const std::vector<double> painted =
      reference::cut(painter.expose(robots), settings.camera.width, window);
  Compared result;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    result.worst = std::max(result.worst, std::abs(painted[i] - expected[i]));
  }
  const double white = full * settings.albedos.cap;
  const optics::Pixel a = reference::middle(painted, window, white);
  const optics::Pixel b = reference::middle(expected, window, white);
  result.off = std::hypot(a.x - b.x, a.y - b.y);
  return result;
}

TEST(CameraPainterShape, CirclesHaveCorrectPositionsAllOverThePicture) {
  const PaintedRobot robots[] = {
      {0.60, 0.45, 0.3}, {0.05, 0.05, 2.0}, {1.14, 0.84, 0.77}, {0.3103, 0.2207, 1.111}};
  for (const PaintedRobot& robot : robots) {
    const Compared result = compare(plain(), robot);
    EXPECT_LT(result.off, 0.002) << robot.x << ", " << robot.y;
    EXPECT_LT(result.worst, 1.5) << robot.x << ", " << robot.y;
  }
}

TEST(CameraPainterShape, CirclesHaveCorrectPositionsWithOtherLenses) {
  PainterSettings blurred = plain();
  blurred.imaging.blur = 2.5;
  PainterSettings sharp = plain();
  sharp.imaging.blur = 0.4;
  PainterSettings bent = plain();
  bent.camera.k1 = -0.3;
  const PainterSettings cases[] = {plain(1920, 1080), plain(640, 480), blurred, sharp, bent};
  for (const PainterSettings& settings : cases) {
    const Compared result = compare(settings, {0.9103, 0.7107, 1.111});
    EXPECT_LT(result.off, 0.002) << settings.camera.width << " " << settings.imaging.blur;
    // With a lens sharper than a cell, the cells are slightly visible.
    EXPECT_LT(result.worst, settings.imaging.blur < 0.5 ? 3 : 1.5)
        << settings.camera.width << " " << settings.imaging.blur;
  }
}

TEST(CameraPainterShape, MotionIsBlurredOverTheExposure) {
  PainterSettings settings = plain();
  const Compared slow = compare(settings, {0.7, 0.5, 1, 0.04, -0.03, 0.5}, 16);
  EXPECT_LT(slow.off, 0.002);
  EXPECT_LT(slow.worst, 1.5);
  settings.exposure = 0.025;
  settings.gain = 0.4;
  const Compared fast = compare(settings, {0.7, 0.5, 1, 0.12, 0.05, 2}, 16);
  EXPECT_LT(fast.off, 0.002);
  EXPECT_LT(fast.worst, 1.5);
}

TEST(CameraPainterShape, DiscsOnTheFloorHaveCorrectPositions) {
  PainterSettings settings = plain();
  settings.discs = {{0.3107, 0.2203, 0.009, 0.07}, {0.9, 0.7, 0.0055, 0.07}};
  CameraPainter painter(settings);
  painter.setLight(lit(1));
  const std::vector<float> picture = painter.expose({});
  const optics::CameraModel model(settings.camera);
  const double full = kFullSignal * (1 + settings.ambient);
  for (const FloorDisc& disc : settings.discs) {
    const optics::Pixel at = model.project(disc.x, disc.y, 0);
    const Window window{static_cast<int>(at.x) - 12, static_cast<int>(at.y) - 12, 25, 25};
    const std::vector<double> expected =
        reference::blurred(window, settings.imaging.blur, 24, [&](optics::Pixel pixel) {
          const auto place = model.toPlane(pixel, 0);
          const bool on = std::hypot(place->x - disc.x, place->y - disc.y) < disc.radius;
          return full * (on ? disc.albedo / settings.albedos.floor : 1);
        });
    const std::vector<double> painted = reference::cut(picture, settings.camera.width, window);
    const optics::Pixel a = reference::middle(painted, window, full);
    const optics::Pixel b = reference::middle(expected, window, full);
    EXPECT_LT(std::hypot(a.x - b.x, a.y - b.y), 0.003);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(painted[i], expected[i], 1.5) << i;
  }
}

}  // namespace
}  // namespace lab::sim::camera_painter_shape_test
