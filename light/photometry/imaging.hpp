/// Noise and blur of a camera.
#pragma once

#include <optional>

namespace lab::optics {

/// [px^2] variance of the square pixel aperture.
inline constexpr double kPixelBox = 1.0 / 12;

/// Noise and blur of an 8-bit camera. [DN] are grey values, 0..255, linear in light; the black
/// level is the same before and after linearisation.
struct Imaging {
  double blur = 0.75;  ///< [px] standard deviation of the point spread, without the pixel aperture
  double read_noise = 1.2;   ///< [DN] standard deviation in the dark
  double shot_gain = 0.026;  ///< [DN] variance for each DN of signal
  double black = 2.0;        ///< [DN]
  bool compressed = false;   ///< JPEG, H.264 ...: errors of neighbouring pixels are correlated
  /// [1] light is the grey value to this power (light/photometry/camera_response.hpp). 1: linear.
  /// 2.2: gamma-encoded, as by webcams, phones and most films. Empty: unknown, treated as linear.
  std::optional<double> gamma = {};

  bool operator==(const Imaging&) const = default;
};

}  // namespace lab::optics
