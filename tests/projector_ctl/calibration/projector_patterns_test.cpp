// Structured light without noise except rounding, with linear and nonlinear projectors.
#include "projector_ctl/calibration/projector_patterns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "light/field/field.hpp"
#include "light/optics/simulated_camera.hpp"
#include "light/optics/simulated_projector.hpp"

namespace lab::calibration::projector_patterns_test {
namespace {

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;
constexpr int kColumns = 320;
constexpr int kRows = 240;

struct Scene {
  double gamma = 1;
  double surface = optics::kSensorHeight;              ///< [m]
  std::array<double, 3> projector = {0.6, 1.18, 2.1};  ///< [m]
  bool projector_known = false;
  optics::ProjectorModel real{kWidth, kHeight, 1920, 1080};
  double bright = 200;  ///< [DN]
};

PatternView viewOf(const Scene& scene) {
  PatternView view;
  view.camera = optics::simulatedCamera(kColumns, kRows, kWidth, kHeight);
  view.plane = {1920, 1080, kWidth, kHeight, optics::kSensorHeight};
  view.surface = scene.surface;
  if (scene.projector_known) view.projector = scene.projector;
  view.assumed = optics::ProjectorModel(kWidth, kHeight, 1920, 1080);
  return view;
}

PatternReader read(const Scene& scene) {
  const PatternView view = viewOf(scene);
  const auto patterns = projectorPatterns(kWidth, kHeight);
  PatternReader reader(view, patterns);
  const optics::CameraModel camera(view.camera);
  const optics::ProjectorWarp warp(view.assumed, scene.real);
  optics::GreyImage picture(kColumns, kRows);
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const light::CompiledLayers layers({patterns[i].layer});
    for (int v = 0; v < kRows; ++v) {
      for (int u = 0; u < kColumns; ++u) {
        const auto seen =
            camera.toPlane({static_cast<double>(u), static_cast<double>(v)}, scene.surface);
        const double scale =
            (scene.projector[2] - optics::kSensorHeight) / (scene.projector[2] - scene.surface);
        const optics::Place place{scene.projector[0] + scale * (seen->x - scene.projector[0]),
                                  scene.projector[1] + scale * (seen->y - scene.projector[1])};
        const auto source = warp.source(place);
        const double light = source ? layers.evaluate(source->x, source->y) : 0;
        picture.row(v)[u] = static_cast<std::uint8_t>(
            std::lround(10 + scene.bright * std::pow(light, scene.gamma)));
      }
    }
    reader.add(i, picture.view());
  }
  return reader;
}

/// Largest error of any observation, in pixels of the projector.
double worst(const PatternReader& reader, const optics::ProjectorModel& real) {
  double most = 0;
  for (const ProjectorObservation& observation : reader.observations()) {
    const optics::Pixel pixel = real.pixelOf(observation.place);
    most = std::max(most, std::hypot(pixel.x - observation.pixel.x, pixel.y - observation.pixel.y));
  }
  return most;
}

TEST(ProjectorPatterns, AllAreValidFields) {
  const auto patterns = projectorPatterns(kWidth, kHeight);
  EXPECT_EQ(patterns.size(), 26U);
  for (const LightPattern& pattern : patterns) {
    EXPECT_FALSE(light::validate(pattern.layer)) << *light::validate(pattern.layer);
  }
}

TEST(ProjectorPatterns, AreDecodedToASmallFractionOfAPixel) {
  const optics::ProjectorModel bent =
      optics::simulatedProjector(kWidth, kHeight, 1920, 1080, {0.15, 0.08, 0, 0});
  for (const optics::ProjectorModel& real :
       {optics::ProjectorModel(kWidth, kHeight, 1920, 1080), bent}) {
    Scene scene;
    scene.real = real;
    const PatternReader reader = read(scene);
    EXPECT_GT(reader.observations().size(), 100U);
    // Rounding to grey levels causes 0.03 px in the middle of a square; the limit leaves some
    // margin.
    EXPECT_LT(worst(reader, real), 0.15);
  }
}

TEST(ProjectorPatterns, GammaCancels) {
  Scene scene;
  scene.gamma = 2.2;
  const PatternReader reader = read(scene);
  EXPECT_GT(reader.observations().size(), 100U);
  EXPECT_LT(worst(reader, scene.real), 0.2);
}

TEST(ProjectorPatterns, FloorIsCorrectedIfTheProjectorPositionIsKnown) {
  Scene scene;
  scene.surface = 0;
  EXPECT_THROW(read(scene), std::invalid_argument);
  scene.projector_known = true;
  EXPECT_LT(worst(read(scene), scene.real), 0.15);
}

TEST(ProjectorPatterns, CountsUnusablePoints) {
  Scene scene;
  const PatternCount good = read(scene).count();
  EXPECT_GT(good.pixels, 30'000);
  EXPECT_EQ(good.dark + good.saturated + good.unclear, 0);
  scene.bright = 10;
  EXPECT_EQ(read(scene).count().dark, good.pixels);
  scene.bright = 245;
  EXPECT_EQ(read(scene).count().saturated, good.pixels);
  EXPECT_TRUE(read(scene).observations().empty());
}

}  // namespace
}  // namespace lab::calibration::projector_patterns_test
