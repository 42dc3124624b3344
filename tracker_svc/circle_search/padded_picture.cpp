#include "tracker_svc/circle_search/padded_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace lab::detector {

optics::GreyView PaddedPicture::begin(const optics::GreyView& picture, int padding) {
  picture_ = picture;
  padding_ = padding;
  width_ = picture.width + 2 * padding;
  height_ = picture.height + 2 * padding;
  columns_ = (width_ + kTile - 1) / kTile;
  filled_.assign(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>((height_ + kTall - 1) / kTall),
      0);
  pixels_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  return {pixels_.data(), width_, height_, width_};
}

void PaddedPicture::need(const Region& part) {
  const int right = std::min(part.right, width_ - 1) / kTile;
  const int bottom = std::min(part.bottom, height_ - 1) / kTall;
  if (part.right < 0 || part.bottom < 0) return;
  for (int row = std::max(part.top, 0) / kTall; row <= bottom; ++row) {
    for (int column = std::max(part.left, 0) / kTile; column <= right; ++column) {
      char& filled = filled_[static_cast<std::size_t>(row * columns_ + column)];
      if (filled != 0) continue;
      filled = 1;
      fill({column * kTile, row * kTall, std::min((column + 1) * kTile, width_) - 1,
            std::min((row + 1) * kTall, height_) - 1});
    }
  }
}

void PaddedPicture::fill(const Region& tile) {
  const int end = tile.right + 1;
  const int first = std::clamp(padding_, tile.left, end);  // within the picture's columns
  const int last = std::clamp(padding_ + picture_.width, tile.left, end);
  const bool columns_inside = last - first == kTile;
  for (int y = tile.top; y <= tile.bottom; ++y) {
    const std::uint8_t* from = picture_.row(std::clamp(y - padding_, 0, picture_.height - 1));
    std::uint8_t* to = pixels_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    if (columns_inside) {  // the usual case
      std::memcpy(to + first, from + (first - padding_), kTile);
      continue;
    }
    std::fill(to + tile.left, to + first, from[0]);
    if (first < last) std::copy(from + (first - padding_), from + (last - padding_), to + first);
    std::fill(to + last, to + end, from[picture_.width - 1]);
  }
}

}  // namespace lab::detector
