/// Whether a picture can be used at all.
#pragma once

#include <cstdint>
#include <string>

#include "light/optics/grey_image.hpp"

namespace lab::tracker {

struct Exposure {
  double brightness = 0;   ///< [1] mean, of full scale
  double darkest = 0;      ///< [DN]
  bool dark = false;       ///< no cap could be told from the noise
  bool saturated = false;  ///< so much is at full scale that the exposure is too long
};

/// Looks at one pixel in a few hundred: that costs next to nothing.
class PictureCheck {
 public:
  /// @param black [DN] of no light at all
  explicit PictureCheck(double black) : black_(black) {}

  Exposure look(const optics::GreyView& picture);

  [[nodiscard]] std::int64_t dark() const { return dark_; }            ///< pictures so far
  [[nodiscard]] std::int64_t saturated() const { return saturated_; }  ///< pictures so far

 private:
  double black_;
  std::int64_t dark_ = 0;
  std::int64_t saturated_ = 0;
};

/// Whether the camera sees anything: a lens cap, an exposure that is far off or too few pixels
/// leave a run without a single pose.
class BlindCheck {
 public:
  /// @param circle [px] smallest radius of a small circle
  /// @param black [DN] of no light at all, as the calibration has it
  BlindCheck(double circle, double black) : circle_(circle), black_(black) {}

  /// @param time [s] of the picture
  void add(double time, const Exposure& exposure, bool any_cap);

  /// Why no cap may have been seen for ten seconds; empty: one was.
  [[nodiscard]] std::string text() const;

 private:
  double circle_;
  double black_;
  double since_ = 0;  ///< [s] the first picture without a cap
  double last_ = 0;   ///< [s] the last one
  std::int64_t pictures_ = 0;
  std::int64_t dark_ = 0;
  std::int64_t saturated_ = 0;
  double darkest_ = 0;     ///< [DN] of all pictures
  double brightness_ = 0;  ///< [1] of the last one
};

}  // namespace lab::tracker
