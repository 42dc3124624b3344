/// The pixels of one circle, packed for the fit. Internal to the circle fit.
#pragma once

#include <memory>

#include "tracker_svc/circle_fit.hpp"

namespace lab::detector::fit {

/// Eight numbers that are worked on together. The order of every sum is fixed by these eight lanes,
/// so the results depend on the processor in the last bits only: some multiply and add in one.
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

class PixelLayout;

/// Pixels around one point of the picture, row by row; places are relative to that point. Where
/// every row is looked at, they look the same upside down: the last place lies opposite the first,
/// seen from that point.
struct Window {
  std::shared_ptr<const PixelLayout> pixels;  ///< whose the places are
  double base_x = 0;                          ///< [px] in the picture
  double base_y = 0;
  int count = 0;             ///< a multiple of kLanes
  int places = 0;            ///< of them that are places, and do not fill up the last eight
  bool plain = false;        ///< only the last eight have less than eight pixels, and none is full
  const float* x = nullptr;  ///< [px]
  const float* y = nullptr;
  alignas(32) float value[kMostPixels + 2 * kLanes];  ///< [DN]
  Slopes slopes[kMostPixels / kLanes + 2];
  /// [DN] on white, by a fit with edges or layLight(); weights while a plain fit runs
  alignas(32) float light[kMostPixels + 2 * kLanes];
  alignas(32) float residual[kMostPixels + 2 * kLanes];  ///< of the last fit, weighted
};

}  // namespace lab::detector::fit
