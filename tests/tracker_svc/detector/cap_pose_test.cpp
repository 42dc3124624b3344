#include "tracker_svc/detector/cap_pose.hpp"

#include <gtest/gtest.h>

namespace lab::detector {
namespace {

constexpr PaintLook kClean{.white = 200, .ratio = 0.08, .error = 0.002, .blur = 0.8};

TEST(LightOnTop, MovesNothingWhereItIsTheSameOnBothCircles) {
  EXPECT_EQ(movedByLightOnTop(kClean, kClean), 0);
  // Haze, or another black level, of 20 DN: in full light and across a light edge.
  PaintLook hazy = kClean;
  hazy.ratio = (0.08 * 200 + 20) / (200 + 20);
  hazy.white = 220;
  PaintLook shaded = hazy;
  shaded.ratio = (0.08 * 60 + 20) / (60 + 20);
  shaded.white = 80;
  EXPECT_EQ(movedByLightOnTop(hazy, hazy), 0);
  EXPECT_EQ(movedByLightOnTop(shaded, hazy), 0);
  EXPECT_EQ(movedByLightOnTop(hazy, shaded), 0);
  // Paint of which nobody told.
  PaintLook grey = kClean;
  grey.ratio = 0.15;
  EXPECT_EQ(movedByLightOnTop(grey, grey), 0);
}

TEST(LightOnTop, MovesTheCircleThatHasMoreOfIt) {
  PaintLook lit = kClean;
  lit.white = 240;
  lit.ratio = 56.0 / 240;  // 40 DN on top
  // 40 DN, less 2 % of 240 for the paint and 3 errors of 0.62 DN, of a contrast of 184 DN.
  EXPECT_NEAR(movedByLightOnTop(lit, kClean), 2.5066 * 0.8 * (36.8 - 4.8 - 1.87) / 184, 1e-3);
  EXPECT_EQ(movedByLightOnTop(kClean, lit), 0);
  PaintLook dim = lit;
  dim.error = 0.06;  // [1] of which nothing is sure
  EXPECT_EQ(movedByLightOnTop(dim, kClean), 0);
}

}  // namespace
}  // namespace lab::detector
