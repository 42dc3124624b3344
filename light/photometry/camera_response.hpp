/// From the grey steps of a camera that encodes them for the eye to amounts of light, and back.
#pragma once

#include <array>
#include <cstdint>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::optics {

/// Of webcams, phones and films made for people: near enough to sRGB and BT.709, which are 2.2 over
/// most of their range.
inline constexpr double kVideoGamma = 2.2;

/// Of the part of a grey step's way from black to full scale, light is the power `gamma`; steps up
/// to black stay what they are, and so does full scale.
class CameraResponse {
 public:
  /// Grey steps are amounts of light.
  CameraResponse() = default;

  /// @param gamma above 0, 1: linear
  /// @param black [DN] of no light, 0 to 254
  explicit CameraResponse(double gamma, double black = 0);
  explicit CameraResponse(const Imaging& imaging)
      : CameraResponse(imaging.gamma.value_or(1), imaging.black) {}

  [[nodiscard]] bool isLinear() const { return gamma_ == 1; }

  /// The light of a grey step [DN], both from 0 to 255.
  [[nodiscard]] double light(double grey) const;

  /// The grey step [DN] of a light, both from 0 to 255.
  [[nodiscard]] double grey(double light) const;

  /// The picture in amounts of light, rounded to whole steps: the picture itself where it is
  /// linear, else one of one's own, which lives until the next call.
  [[nodiscard]] GreyView linear(const GreyView& picture);

 private:
  [[nodiscard]] double raised(double value, double power) const;

  double gamma_ = 1;
  double black_ = 0;
  std::array<std::uint8_t, 256> steps_{};
  GreyImage image_;
};

}  // namespace lab::optics
