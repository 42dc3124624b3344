#include "light/optics/simulated_projector.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::optics {
namespace {

constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

ProjectorModel projector(const ProjectorFaults& faults) {
  return simulatedProjector(kWidth, kHeight, 1920, 1080, faults);
}

double width(const ProjectorModel& model, double row) {
  return model.placeOf({1919.5, row})->x - model.placeOf({-0.5, row})->x;
}

TEST(SimulatedProjector, WithoutFaultsTheArenaFillsThePicture) {
  EXPECT_TRUE(projector({}).isNominal());
  const ProjectorWarp warp(projector({}), projector({}));
  EXPECT_TRUE(warp.isIdentity());
}

TEST(SimulatedProjector, WithSmallFaultsTheArenaNearlyFillsThePicture) {
  const ProjectorModel model = projector({1e-6, 1e-6, 0, 0});
  for (const Place& place : {Place{0, 0}, {1.2, 0}, {1.2, 0.9}, {0.3, 0.7}}) {
    const Pixel expected = projector({}).pixelOf(place);
    const Pixel pixel = model.pixelOf(place);
    EXPECT_NEAR(pixel.x, expected.x, 0.01);
    EXPECT_NEAR(pixel.y, expected.y, 0.01);
  }
}

TEST(SimulatedProjector, KeystoneIsWiderFarFromTheProjector) {
  // After zooming out the picture has a wider angle, so its sides differ slightly more.
  const ProjectorModel model = projector({0.15, 0, 0, 0});
  EXPECT_NEAR(width(model, 1079.5) / width(model, -0.5), 1.15, 0.015);
  EXPECT_GT(width(model, 1079.5) / width(model, -0.5), 1.15);
}

TEST(SimulatedProjector, BarrelPullsTheCornersIn) {
  const ProjectorModel model = projector({0, 0.08, 0, 0});
  const Place corner = *model.placeOf({-0.5, -0.5});
  // To first order there is no distortion near the middle, so the picture would extend this far.
  const Place near = *model.placeOf({959.5 - 9.6, 539.5 - 5.4});
  const double straight = 100 * std::hypot(near.x - 0.6, near.y - 0.45);
  EXPECT_NEAR(std::hypot(corner.x - 0.6, corner.y - 0.45) / straight, 0.92, 0.015);
}

TEST(SimulatedProjector, CoversTheArenaAndTouchesItsBorder) {
  for (const ProjectorFaults& faults :
       {ProjectorFaults{0.15, 0.08, 0, 0}, {-0.3, 0, 0, 0}, {0, -0.1, 0, 0}, {0.1, 0.15, 0, 0}}) {
    const ProjectorWarp warp(projector({}), projector(faults));
    double least = 1e9;
    for (int i = 0; i <= 120; ++i) {
      const double along = i / 120.0;
      for (const Place& place : {Place{along * kWidth, 0},
                                 {along * kWidth, kHeight},
                                 {0, along * kHeight},
                                 {kWidth, along * kHeight}}) {
        least = std::min(least, warp.marginInside(place));
      }
    }
    EXPECT_NEAR(least, 0, 0.05);
  }
}

TEST(SimulatedProjector, OffsetShiftsThePicture) {
  const ProjectorModel model = projector({0.1, 0.05, 0, 0});
  const ProjectorModel shifted = projector({0.1, 0.05, 0.03, -0.02});
  const Pixel before = model.pixelOf({0.4, 0.3});
  const Pixel after = shifted.pixelOf({0.43, 0.28});
  EXPECT_NEAR(before.x, after.x, 1e-9);
  EXPECT_NEAR(before.y, after.y, 1e-9);
}

TEST(ProjectorWarp, CalibratedLightIsNotDisplaced) {
  const ProjectorModel real = projector({0.15, 0.08, 0.02, 0});
  const ProjectorWarp warp(real, real);
  const auto source = warp.source({0.7, 0.2});
  ASSERT_TRUE(source);
  EXPECT_NEAR(source->x, 0.7, 1e-9);
  EXPECT_NEAR(source->y, 0.2, 1e-9);
  EXPECT_FALSE(warp.source({0.001, 0.899}));  // shifted out of the picture
}

}  // namespace
}  // namespace lab::optics
