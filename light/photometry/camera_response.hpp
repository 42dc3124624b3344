/// Converts grey values of a gamma-encoding camera to light and back.
#pragma once

#include <array>
#include <cstdint>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::optics {

/// Gamma of webcams, phones and consumer films: close to sRGB and BT.709, which are about 2.2 over
/// most of their range.
inline constexpr double kVideoGamma = 2.2;

/// Between black and full scale, light is the relative grey value to the power of `gamma`; values
/// up to black and full scale stay unchanged.
class CameraResponse {
 public:
  /// Linear.
  CameraResponse() = default;

  /// @param gamma above 0, 1: linear
  /// @param black [DN] without light, 0 to 254
  explicit CameraResponse(double gamma, double black = 0);
  explicit CameraResponse(const Imaging& imaging)
      : CameraResponse(imaging.gamma.value_or(1), imaging.black) {}

  [[nodiscard]] bool isLinear() const { return gamma_ == 1; }

  /// The light of a grey value [DN], both from 0 to 255.
  [[nodiscard]] double light(double grey) const;

  /// The grey value [DN] of a light, both from 0 to 255.
  [[nodiscard]] double grey(double light) const;

  /// The picture converted to light, rounded to integers: the picture itself if the response is
  /// linear, else an internal copy that is valid until the next call.
  [[nodiscard]] GreyView linear(const GreyView& picture);

 private:
  [[nodiscard]] double raised(double value, double power) const;

  double gamma_ = 1;
  double black_ = 0;
  std::array<std::uint8_t, 256> steps_{};
  GreyImage image_;
};

}  // namespace lab::optics
