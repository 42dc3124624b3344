/// A picture that goes on beyond its edges, so that what lies at an edge has neighbours like
/// everything else.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/grey_image.hpp"

namespace lab::detector {

/// A part of a picture: first to last column and row, both included.
struct Region {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// Pixel (x, y) of the picture is pixel (x + padding, y + padding) of the padded one.
class PaddedPicture {
 public:
  /// Begins with another picture, of which nothing is there yet.
  /// @param padding [px] on every side, in which the outermost pixels are repeated
  /// @return of the size of all of it; valid until the next call
  [[nodiscard]] optics::GreyView begin(const optics::GreyView& picture, int padding);

  /// Makes sure that a part of the padded picture is there, as far as it lies in it.
  void need(const Region& part);

  /// The same coordinates without a copy, for who reads no pixel that the picture has not.
  [[nodiscard]] static optics::GreyView within(const optics::GreyView& picture, int padding) {
    return {picture.data - padding * picture.stride - padding, picture.width + 2 * padding,
            picture.height + 2 * padding, picture.stride};
  }

 private:
  static constexpr int kTile = 32;  // [px] columns of what is filled at once
  static constexpr int kTall = 8;   // [px] rows of it

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
