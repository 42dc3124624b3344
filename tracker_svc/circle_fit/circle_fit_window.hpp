/// The pixels of one circle, packed for the fit. Internal to the circle fit.
#pragma once

#include <memory>

#include "tracker_svc/circle_fit.hpp"

namespace lab::detector::fit {

/// Number of values processed together. The order of every sum is fixed by these eight lanes, so
/// results differ between processors only in the last bits, by fused multiply-add.
constexpr int kLanes = 8;
typedef float Lanes __attribute__((vector_size(32)));
typedef int LaneMask __attribute__((vector_size(32)));

constexpr int kMostPixels = 4000;
constexpr float kNoPixel = -1;  ///< value of padding lanes

/// Model derivatives at eight pixels, kept from one pass to the next.
struct Slopes {
  alignas(32) float weight[kLanes];  ///< [1/DN^2] inverse of the expected variance
  alignas(32) float by[8][kLanes];   ///< derivative of the value by each unknown
};

class PixelLayout;

/// Pixels around one point of the picture, row by row, with positions relative to that point. If
/// every row is used, the list is symmetric: the last position is opposite the first.
struct Window {
  std::shared_ptr<const PixelLayout> pixels;  ///< layout of the positions
  double base_x = 0;                          ///< [px] in the picture
  double base_y = 0;
  int count = 0;             ///< a multiple of kLanes
  int places = 0;            ///< without padding
  bool plain = false;        ///< only the last eight lanes have padding, and no pixel is saturated
  const float* x = nullptr;  ///< [px]
  const float* y = nullptr;
  alignas(32) float value[kMostPixels + 2 * kLanes];  ///< [DN]
  Slopes slopes[kMostPixels / kLanes + 2];
  /// [DN] light on white, from a fit with edges or layLight(); weights during a plain fit
  alignas(32) float light[kMostPixels + 2 * kLanes];
  alignas(32) float residual[kMostPixels + 2 * kLanes];  ///< of the last fit, weighted
};

}  // namespace lab::detector::fit
