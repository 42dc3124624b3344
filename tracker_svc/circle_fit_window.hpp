/// The pixels of one circle, packed for the fit. Internal to the circle fit.
#pragma once

#include "optics/image.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::tracker::fit {

/// Eight numbers that are worked on together. The order of every sum is fixed by these eight lanes,
/// so the results do not depend on what the processor can do at once.
constexpr int kLanes = 8;
typedef float Lanes __attribute__((vector_size(32)));
typedef int LaneMask __attribute__((vector_size(32)));

constexpr int kMostPixels = 4000;
constexpr float kNoPixel = -1;  ///< value of the lanes that fill up the last group

/// What the model says of eight pixels: kept from one pass to the next.
struct Slopes {
  alignas(32) float weight[kLanes];  ///< [1/DN^2] one over the expected variance
  alignas(32) float by[8][kLanes];   ///< slope of the value by each unknown
};

/// Pixels around one point of the picture, row by row; places are relative to that point.
struct Window {
  double base_x = 0;  ///< [px] in the picture
  double base_y = 0;
  int count = 0;  ///< a multiple of kLanes
  alignas(32) float x[kMostPixels + 2 * kLanes];
  alignas(32) float y[kMostPixels + 2 * kLanes];
  alignas(32) float value[kMostPixels + 2 * kLanes];  ///< [DN]
  Slopes slopes[kMostPixels / kLanes + 2];
  alignas(32) float light[kMostPixels + 2 * kLanes];     ///< [DN] on white, by the last fit
  alignas(32) float residual[kMostPixels + 2 * kLanes];  ///< of the last fit, weighted
};

/// Takes the pixels within `margin` px outside the outline centred on (base_x, base_y).
/// @return false where the window would leave the picture
bool gather(const optics::GreyView& picture, double base_x, double base_y, const DiscShape& shape,
            float margin, Window& window);

}  // namespace lab::tracker::fit
