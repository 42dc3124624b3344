/// A picture that goes on beyond its edges, so that what lies at an edge has neighbours like
/// everything else.
#pragma once

#include <span>
#include <vector>

#include "optics/image.hpp"

namespace lab::tracker {

/// Room for the neighbours of a circle at the edge, and a whole number of the words that the search
/// tests at once.
inline constexpr int kPadding = 32;  // [px]

class PaddedPicture {
 public:
  /// The picture with its outermost pixels repeated kPadding times on every side: pixel (x, y) of the
  /// picture is pixel (x + kPadding, y + kPadding) of this one. Valid until the next call.
  [[nodiscard]] optics::GreyView around(const optics::GreyView& picture);

  /// The same coordinates without a copy, for who reads no pixel that the picture has not.
  [[nodiscard]] static optics::GreyView within(const optics::GreyView& picture) {
    return {picture.data - kPadding * picture.stride - kPadding, picture.width + 2 * kPadding,
            picture.height + 2 * kPadding, picture.stride};
  }

 private:
  std::vector<std::uint8_t> pixels_;
};

}  // namespace lab::tracker
