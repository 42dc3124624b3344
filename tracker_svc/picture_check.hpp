/// Whether a picture can be used at all.
#pragma once

#include <cstdint>

#include "optics/image.hpp"

namespace lab::tracker {

struct Exposure {
  double brightness = 0;  ///< [1] mean, of full scale
  bool dark = false;      ///< no cap could be told from the noise
  bool saturated = false; ///< so much is at full scale that the exposure is too long
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

}  // namespace lab::tracker
