#include "tracker_svc/detector/cap_pose.hpp"

#include <gtest/gtest.h>

namespace lab::detector {
namespace {

constexpr PaintEstimate kClean{.white = 200, .ratio = 0.08, .error = 0.002, .blur = 0.8};

TEST(LightOnTop, DisplacesNothingIfEqualOnBothCircles) {
  EXPECT_EQ(shiftByGlare(kClean, kClean), 0);
  // Haze, or another black level, of 20 DN: in full light and across a light edge.
  PaintEstimate hazy = kClean;
  hazy.ratio = (0.08 * 200 + 20) / (200 + 20);
  hazy.white = 220;
  PaintEstimate shaded = hazy;
  shaded.ratio = (0.08 * 60 + 20) / (60 + 20);
  shaded.white = 80;
  EXPECT_EQ(shiftByGlare(hazy, hazy), 0);
  EXPECT_EQ(shiftByGlare(shaded, hazy), 0);
  EXPECT_EQ(shiftByGlare(hazy, shaded), 0);
  // Unknown paint.
  PaintEstimate grey = kClean;
  grey.ratio = 0.15;
  EXPECT_EQ(shiftByGlare(grey, grey), 0);
}

TEST(LightOnTop, DisplacesTheCircleThatHasMoreOfIt) {
  PaintEstimate lit = kClean;
  lit.white = 240;
  lit.ratio = 56.0 / 240;  // 40 DN of glare
  // 40 DN, less 2 % of 240 for the paint and 3 standard errors of 0.62 DN, of a contrast of 184 DN.
  EXPECT_NEAR(shiftByGlare(lit, kClean), 2.5066 * 0.8 * (36.8 - 4.8 - 1.87) / 184, 1e-3);
  EXPECT_EQ(shiftByGlare(kClean, lit), 0);
  PaintEstimate dim = lit;
  dim.error = 0.06;  // [1] too uncertain
  EXPECT_EQ(shiftByGlare(dim, kClean), 0);
}

}  // namespace
}  // namespace lab::detector
