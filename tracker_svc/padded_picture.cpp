#include "tracker_svc/padded_picture.hpp"

#include <algorithm>
#include <cstring>

namespace lab::tracker {

optics::GreyView PaddedPicture::around(const optics::GreyView& picture) {
  const int width = picture.width + 2 * kPadding;
  const int height = picture.height + 2 * kPadding;
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* from = picture.row(std::clamp(y - kPadding, 0, picture.height - 1));
    std::uint8_t* to = pixels_.data() + static_cast<std::ptrdiff_t>(y) * width;
    std::memset(to, from[0], kPadding);
    std::memcpy(to + kPadding, from, static_cast<std::size_t>(picture.width));
    std::memset(to + kPadding + picture.width, from[picture.width - 1], kPadding);
  }
  return {pixels_.data(), width, height, width};
}

}  // namespace lab::tracker
