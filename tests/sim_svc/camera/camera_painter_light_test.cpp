// Position and brightness of the projector's light in the simulated camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::camera_painter_light_test {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

PainterSettings plain() {
  PainterSettings settings;
  settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
  settings.vignetting = 0;
  settings.unevenness = 0;
  settings.hot_pixels = 0;
  settings.texture = false;
  return settings;
}

light::Layer uniform(double intensity) {
  light::Layer layer;
  layer.intensity = intensity;
  return layer;
}

light::Field lit(double intensity) { return {{uniform(intensity)}, {}, 1}; }

/// Bright for x > `edge`, with the projector's smallest edge width.
light::Field stepAt(double edge) {
  light::Layer half = uniform(1);
  half.kind = light::LayerKind::kHalfPlane;
  half.x = edge;
  return {{uniform(0.2), half}, {}, 1};
}

double greyAt(const std::vector<float>& picture, const optics::Pixel& at) {
  return static_cast<double>(picture[static_cast<std::size_t>(std::lround(at.y)) * kWidth +
                                     static_cast<std::size_t>(std::lround(at.x))]);
}

/// Distance from `at` to the right [px] at which its row changes from dark to bright, measured by
/// the share of darkness.
double crossing(const std::vector<float>& picture, const optics::Pixel& at) {
  constexpr int kReach = 5;
  const auto row = static_cast<std::size_t>(std::lround(at.y)) * kWidth;
  const int column = static_cast<int>(std::lround(at.x));
  const auto grey = [&](int x) {
    return static_cast<double>(picture[row + static_cast<std::size_t>(x)]);
  };
  const double dark = grey(column - kReach);
  const double bright = grey(column + kReach);
  double darkness = 0;
  for (int x = column - kReach; x <= column + kReach; ++x) {
    darkness += (bright - grey(x)) / (bright - dark);
  }
  return column - kReach - 0.5 + darkness - at.x;
}

/// Position in the row of `at` of the line x = `x` at height z; the camera is slightly tilted.
optics::Pixel onRow(const optics::CameraModel& model, double x, double z, double row) {
  double y = 0.45;
  optics::PlaneScale scale;
  for (int i = 0; i < 10; ++i) {
    const optics::Pixel at = model.project(x, y, z, scale);
    y += (row - at.y) / scale.vy;
  }
  return model.project(x, y, z);
}

TEST(CameraPainterLight, PatternsAreCorrectOnCapsAndShiftedOnTheFloor) {
  const PainterSettings settings = plain();
  const optics::CameraModel model(settings.camera);
  CameraPainter painter(settings);
  for (const double edge : {0.15, 0.40, 0.80, 1.07}) {
    painter.setLight(stepAt(edge));
    // The circles lie above and below the place that is looked at.
    const std::vector<PaintedRobot> robots = {{edge, 0.45, 1.5707963}};
    const double row = std::round(model.project(edge, 0.45, 0.05).y);
    EXPECT_NEAR(crossing(painter.expose(robots), onRow(model, edge, 0.05, row)), 0, 0.01) << edge;
    // 5 cm under a projector 210 cm up: 2.44 mm further from its foot for each 10 cm.
    const double shifted = edge + (edge - 0.60) * 0.0244;
    EXPECT_NEAR(crossing(painter.expose({}), onRow(model, shifted, 0, row)), 0, 0.01) << edge;
  }
}

TEST(CameraPainterLight, ShadowsFallAwayFromTheProjectorAndSidesAreBlack) {
  const PainterSettings settings = plain();
  const optics::CameraModel model(settings.camera);
  CameraPainter painter(settings);
  painter.setLight(lit(1));
  const std::vector<PaintedRobot> robots = {{0.60, 0.60, 0}};
  const std::vector<float> picture = painter.expose(robots);
  const double full = kFullSignal * 1.03 + settings.imaging.black;
  const double dark = kFullSignal * 0.03 + settings.imaging.black;
  // The projector is at y = 1.18: the shadow ends (0.60 - 1.18) * 0.0244 = 1.41 cm behind the
  // robot.
  EXPECT_NEAR(greyAt(picture, model.project(0.60, 0.60 - 0.0375 - 0.009, 0)), dark, 3);
  EXPECT_NEAR(greyAt(picture, model.project(0.60, 0.60 - 0.0375 - 0.020, 0)), full, 3);
  EXPECT_NEAR(greyAt(picture, model.project(0.60, 0.60 + 0.0375 + 0.010, 0)), full, 3);
  // The middle of the cap, and a side that is turned to the projector.
  EXPECT_NEAR(greyAt(picture, model.project(0.60, 0.60, 0.05)),
              kFullSignal * 1.03 * 0.86 / 0.78 + settings.imaging.black, 1);
  const std::vector<PaintedRobot> low = {{0.60, 0.10, 0}};
  EXPECT_NEAR(greyAt(painter.expose(low), model.project(0.60, 0.10 + 0.0375, 0.02)),
              kFullSignal * 0.20 / 0.78 * 1.03 + settings.imaging.black, 4);
}

TEST(CameraPainterLight, ExposureAndGainScaleTheSignalUpToWhite) {
  PainterSettings settings = plain();
  const optics::CameraModel model(settings.camera);
  const optics::Pixel at = model.project(0.5, 0.5, 0);
  const auto seen = [&](double exposure, double gain, double light) {
    settings.exposure = exposure;
    settings.gain = gain;
    CameraPainter painter(settings);
    painter.setLight(lit(light));
    return greyAt(painter.expose({}), at);
  };
  const double black = settings.imaging.black;
  EXPECT_NEAR(seen(0.010, 1, 1), black + 206, 0.01);
  EXPECT_NEAR(seen(0.005, 1, 1), black + 103, 0.01);
  EXPECT_NEAR(seen(0.005, 2, 1), black + 206, 0.01);
  EXPECT_NEAR(seen(0.010, 1, 0), black + 6, 0.01);
  settings.exposure = 0.03;
  settings.gain = 1;
  CameraPainter painter(settings);
  painter.setLight(lit(1));
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(kWidth) * kHeight);
  painter.paint({}, 0, picture);
  EXPECT_EQ(picture[static_cast<std::size_t>(at.y) * kWidth + static_cast<std::size_t>(at.x)], 255);
}

/// Robots on a bright and on a dark side, and one across the edge.
const std::vector<PaintedRobot> kSome = {
    {0.30, 0.30, 1}, {0.60, 0.45, 2, 0.05, 0, 1}, {0.90, 0.60, 3}, {0.965, 0.62, 0.5}};

TEST(CameraPainterLight, ARampIsTheMeanOfItsEnds) {
  CameraPainter painter(plain());
  painter.setLight(stepAt(0.6));
  const std::vector<float> after = painter.expose(kSome);
  painter.setLight(lit(0.3));
  const std::vector<float> before = painter.expose(kSome);
  light::Field ramp = stepAt(0.6);
  ramp.previous = lit(0.3).layers;
  ramp.mix = 0.25;
  painter.setLight(ramp);
  const std::vector<float> between = painter.expose(kSome);
  float worst = 0;
  for (std::size_t i = 0; i < between.size(); ++i) {
    worst = std::max(worst, std::abs(between[i] - (0.75F * before[i] + 0.25F * after[i])));
  }
  EXPECT_LT(worst, 1e-3F);
}

TEST(CameraPainterLight, APictureDoesNotDependOnWhatWasPaintedBefore) {
  light::Field ramp = stepAt(0.6);
  ramp.previous = lit(0.3).layers;
  ramp.mix = 0.25;
  const std::size_t bytes = static_cast<std::size_t>(kWidth) * kHeight;
  std::vector<std::uint8_t> alone(bytes);
  std::vector<std::uint8_t> later(bytes);
  PainterSettings settings;
  settings.camera = plain().camera;
  CameraPainter fresh(settings);
  fresh.setLight(ramp);
  fresh.paint(kSome, 7, alone);
  CameraPainter used(settings);
  used.paint(kSome, 1, later);
  used.setLight(stepAt(0.2));
  used.paint({}, 2, later);
  used.setLight(stepAt(0.6));
  used.paint(std::span(kSome).first(2), 3, later);
  used.setLight(ramp);
  used.paint(kSome, 8, later);
  EXPECT_NE(alone, later) << "the noise of another frame";
  used.paint(kSome, 7, later);
  EXPECT_EQ(alone, later);
  settings.seed = 2;
  CameraPainter other(settings);
  other.setLight(ramp);
  other.paint(kSome, 7, later);
  EXPECT_NE(alone, later) << "another seed";
}

/// Compares thin, curved and repeated layers with the same field during a cross-fade, for which the
/// painter cannot use its simplifications for uniform parts.
TEST(CameraPainterLight, SimplificationsDoNotChangeAnyLayer) {
  std::vector<light::Layer> layers = {uniform(0.1)};
  const auto add = [&](light::LayerKind kind, double x, double y, double size, double inner) {
    light::Layer layer = uniform(0.9);
    layer.kind = kind;
    layer.x = x;
    layer.y = y;
    layer.angle = 0.3;
    layer.size = size;
    layer.inner = inner;
    layer.intensity2 = 0.4;
    layer.softness = 0.002;
    layer.blend = light::Blend::kAdd;
    layers.push_back(layer);
  };
  add(light::LayerKind::kDisk, 0.3, 0.3, 0.1, 0);
  add(light::LayerKind::kRing, 0.8, 0.5, 0.2, 0.195);
  add(light::LayerKind::kHalfPlane, 1.0, 0.7, 0, 0);
  layers.back().blend = light::Blend::kMultiply;
  CameraPainter painter(plain());
  for (const bool striped : {false, true}) {
    std::vector<light::Layer> shown = layers;
    if (striped) {
      add(light::LayerKind::kStripes, 0.5, 0.5, 0.08, 0.4);
      layers.back().blend = light::Blend::kMultiply;
      shown = layers;
    }
    painter.setLight({shown, {}, 1});
    const std::vector<float> quick = painter.expose(kSome);
    // A gradient that is 1 everywhere disables all simplifications.
    light::Layer even = uniform(1);
    even.kind = light::LayerKind::kLinearGradient;
    even.size = 1;
    even.intensity2 = 1;
    even.blend = light::Blend::kMultiply;
    shown.push_back(even);
    painter.setLight({shown, {}, 1});
    const std::vector<float> slow = painter.expose(kSome);
    float worst = 0;
    for (std::size_t i = 0; i < slow.size(); ++i) {
      worst = std::max(worst, std::abs(slow[i] - quick[i]));
    }
    EXPECT_LT(worst, 0.3F) << (striped ? "striped" : "plain");
  }
}

TEST(PainterLight, FollowsTheProjectorsGammaAndVignetting) {
  const optics::ProjectorTone actual(2.2, {0, 0, -0.125, 0, -0.125}, 1.20, 0.90);
  PainterSettings settings = plain();
  const optics::CameraModel camera(settings.camera);
  CameraPainter straight(settings);
  settings.tones.actual = actual;
  CameraPainter dim(settings);
  for (const double intensity : {0.25, 0.5, 0.9}) {
    straight.setLight(lit(1));
    const std::vector<float> white = straight.expose({});
    straight.setLight(lit(0));
    const std::vector<float> dark = straight.expose({});
    dim.setLight(lit(intensity));
    const std::vector<float> seen = dim.expose({});
    for (const optics::Place place : {optics::Place{0.6, 0.45}, {0.1, 0.1}, {1.1, 0.6}}) {
      const optics::Pixel at = camera.project(place.x, place.y, 0);
      const double share =
          (greyAt(seen, at) - greyAt(dark, at)) / (greyAt(white, at) - greyAt(dark, at));
      // A point on the floor gets the light of a point at cap height that is nearer to the
      // projector.
      const double up = settings.cap.height / settings.projector[2];
      const optics::Place meant{place.x + up * (settings.projector[0] - place.x),
                                place.y + up * (settings.projector[1] - place.y)};
      EXPECT_NEAR(share, actual.light(intensity, meant), 0.001) << place.x << " " << intensity;
    }
  }
}

}  // namespace
}  // namespace lab::sim::camera_painter_light_test
