/// A picture extended beyond its edges, so that pixels at an edge have neighbours on all sides.
/// Filled on demand.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/grey_image.hpp"

namespace lab::detector {

/// A part of a picture: first and last column and row, inclusive.
struct Region {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// Pixel (x, y) of the picture is pixel (x + padding, y + padding) of the padded one.
class PaddedPicture {
 public:
  /// Starts with a new picture; nothing is filled yet.
  /// @param padding [px] on every side; repeats the outermost pixels
  /// @return view of the padded size; valid until the next call
  [[nodiscard]] optics::GreyView begin(const optics::GreyView& picture, int padding);

  /// Fills a part of the padded picture (clipped to its size).
  void need(const Region& part);

  /// A view in the same coordinates without a copy. Only pixels inside the picture may be read.
  [[nodiscard]] static optics::GreyView within(const optics::GreyView& picture, int padding) {
    return {picture.data - padding * picture.stride - padding, picture.width + 2 * padding,
            picture.height + 2 * padding, picture.stride};
  }

 private:
  static constexpr int kTile = 32;  // [px] columns filled at once
  static constexpr int kTall = 8;   // [px] rows filled at once

  void fill(const Region& tile);

  optics::GreyView picture_;
  int padding_ = 0;
  int width_ = 0;
  int height_ = 0;
  int columns_ = 0;           // of tiles
  std::vector<char> filled_;  // by tile
  std::vector<std::uint8_t> pixels_;
};

}  // namespace lab::detector
