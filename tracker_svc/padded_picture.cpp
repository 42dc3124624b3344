#include "tracker_svc/padded_picture.hpp"

#include <algorithm>
#include <cstddef>

namespace lab::tracker {

optics::GreyView PaddedPicture::begin(const optics::GreyView& picture, int padding) {
  picture_ = picture;
  padding_ = padding;
  width_ = picture.width + 2 * padding;
  height_ = picture.height + 2 * padding;
  pixels_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  return {pixels_.data(), width_, height_, width_};
}

void PaddedPicture::fill(const Region& part) {
  const int left = std::max(part.left, 0);
  const int right = std::min(part.right, width_ - 1) + 1;
  const int begin = std::clamp(padding_, left, std::max(left, right));
  const int end = std::clamp(padding_ + picture_.width, left, std::max(left, right));
  const int bottom = std::min(part.bottom, height_ - 1);
  if (left >= right) return;
  for (int y = std::max(part.top, 0); y <= bottom; ++y) {
    const std::uint8_t* from = picture_.row(std::clamp(y - padding_, 0, picture_.height - 1));
    std::uint8_t* to = pixels_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    std::fill(to + left, to + begin, from[0]);
    std::copy(from + (begin - padding_), from + (end - padding_), to + begin);
    std::fill(to + end, to + right, from[picture_.width - 1]);
  }
}

}  // namespace lab::tracker
