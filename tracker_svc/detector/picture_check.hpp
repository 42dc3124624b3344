/// Checks the exposure of pictures.
#pragma once

#include <cstdint>
#include <string>

#include "light/optics/grey_image.hpp"

namespace lab::tracker {

struct Exposure {
  double brightness = 0;   ///< [1] mean, of full scale
  double darkest = 0;      ///< [DN]
  bool dark = false;       ///< too dark to distinguish caps from noise
  bool saturated = false;  ///< too large a share is saturated
};

/// Samples one pixel in a few hundred, at negligible cost.
class PictureCheck {
 public:
  /// @param black [DN] level without light
  explicit PictureCheck(double black) : black_(black) {}

  Exposure look(const optics::GreyView& picture);

  [[nodiscard]] std::int64_t dark() const { return dark_; }            ///< pictures so far
  [[nodiscard]] std::int64_t saturated() const { return saturated_; }  ///< pictures so far

 private:
  double black_;
  std::int64_t dark_ = 0;
  std::int64_t saturated_ = 0;
};

/// Explains a run without poses: a lens cap, a wrong exposure, or too few pixels per circle.
class BlindCheck {
 public:
  /// @param circle [px] smallest radius of a small circle
  /// @param black [DN] level without light, from the calibration
  BlindCheck(double circle, double black) : circle_(circle), black_(black) {}

  /// @param time [s] of the picture
  void add(double time, const Exposure& exposure, bool any_cap);

  /// Possible reason why no cap was seen for ten seconds; empty if one was seen.
  [[nodiscard]] std::string text() const;

 private:
  double circle_;
  double black_;
  double since_ = 0;  ///< [s] of the first picture without a cap
  double last_ = 0;   ///< [s] of the last picture
  std::int64_t pictures_ = 0;
  std::int64_t dark_ = 0;
  std::int64_t saturated_ = 0;
  double darkest_ = 0;     ///< [DN] over all pictures
  double brightness_ = 0;  ///< [1] of the last picture
};

}  // namespace lab::tracker
