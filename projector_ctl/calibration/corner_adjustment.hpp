/// A projector set up by hand: the arena's four corners, moved by keys until they lie on the arena.
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
  static constexpr double kStep = 0.5;  ///< [px] a key press
  static constexpr double kFast = 20;   ///< [px] with shift

  /// Begins with the arena's corners at those of the picture, a twentieth inside.
  explicit CornerAdjustment(const calibration::ProjectorPlane& plane);

  /// An arrow moves the selected corner, Tab selects the next; others change nothing.
  void take(DisplayEvent event);

  /// The pixels of (0, 0), (width, 0), (width, height) and (0, height).
  [[nodiscard]] const std::array<optics::Pixel, 4>& pixels() const { return pixels_; }
  [[nodiscard]] std::size_t selected() const { return selected_; }

  /// Empty while the corners cross.
  [[nodiscard]] std::optional<optics::CameraParameters> lens() const;

  /// The arena's outline, a grid every 10 cm, the selected corner, and what the keys do.
  [[nodiscard]] optics::GreyImage picture() const;

 private:
  calibration::ProjectorPlane plane_;
  std::array<optics::Pixel, 4> pixels_;
  std::size_t selected_ = 0;
};

}  // namespace lab::projector
