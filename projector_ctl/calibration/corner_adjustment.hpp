/// Calibrates a projector manually: keys move the arena's four corners in the picture until they
/// coincide with the real corners.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "light/optics/grey_image.hpp"
#include "projector_ctl/calibration/projector_lens.hpp"
#include "projector_ctl/display/display.hpp"

namespace lab::projector {

class CornerAdjustment {
 public:
  static constexpr double kStep = 0.5;  ///< [px] per key press
  static constexpr double kFast = 20;   ///< [px] with shift

  /// Starts with the corners 5 % inside the picture.
  explicit CornerAdjustment(const calibration::ProjectorPlane& plane);

  /// Handles a key: arrows move the selected corner, Tab selects the next; others are ignored.
  void handle(DisplayEvent event);

  /// The pixels of (0, 0), (width, 0), (width, height) and (0, height).
  [[nodiscard]] const std::array<optics::Pixel, 4>& pixels() const { return pixels_; }
  [[nodiscard]] std::size_t selected() const { return selected_; }

  /// Empty if the corners do not form a convex quadrangle.
  [[nodiscard]] std::optional<optics::CameraParameters> lens() const;

  /// The arena's outline, a grid of 10 cm, the selected corner, and help on the keys.
  [[nodiscard]] optics::GreyImage picture() const;

 private:
  calibration::ProjectorPlane plane_;
  std::array<optics::Pixel, 4> pixels_;
  std::size_t selected_ = 0;
};

}  // namespace lab::projector
