/// What a sensor and a lens do to a picture.
#pragma once

#include <optional>

namespace lab::optics {

/// [px^2] variance of the blur by the pixel itself, which sees a square.
inline constexpr double kPixelBox = 1.0 / 12;

/// Noise and blur of an 8-bit camera. [DN] are grey steps, 0..255, linear in light; black, where
/// there is none, is the same step before and after they are made so.
struct Imaging {
  double blur = 0.75;        ///< [px] standard deviation of the point spread, pixel box excluded
  double read_noise = 1.2;   ///< [DN] standard deviation in the dark
  double shot_gain = 0.026;  ///< [DN] variance for each DN of signal
  double black = 2.0;        ///< [DN]
  bool compressed = false;   ///< JPEG, H.264 ...: errors that neighbouring pixels share
  /// [1] light is a grey step's power (light/photometry/camera_response.hpp). 1: linear. 2.2:
  /// encoded for the eye, as by webcams, phones and in most films. Empty: not known, taken for
  /// linear.
  std::optional<double> gamma = {};

  bool operator==(const Imaging&) const = default;
};

}  // namespace lab::optics
