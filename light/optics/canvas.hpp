/// Lines and letters on an RGB picture.
#pragma once

#include <string_view>

#include "light/optics/bitmap_font.hpp"
#include "light/optics/grey_image.hpp"
#include "light/optics/rgb_image.hpp"

namespace lab::tracker {

using optics::kGlyphHeight;
using optics::kGlyphWidth;

/// Draws on a picture; what lies outside is left out.
class Canvas {
 public:
  explicit Canvas(RgbImage& image) : image_(image) {}

  /// A smooth line of this thickness [px] between two places.
  void line(optics::Pixel from, optics::Pixel to, Colour colour, double thickness = 1);

  /// Text with its top left corner at (x, y), letters of 5 x 7 px times `size`. Capitals, digits
  /// and the signs that numbers need; small letters are drawn as capitals, anything else as a box.
  void text(int x, int y, std::string_view text, Colour colour, int size = 1);

  /// Makes a rectangle darker, so that text on it can be read.
  void shade(int x, int y, int width, int height);

 private:
  void blend(int x, int y, Colour colour, double share);

  RgbImage& image_;
};

}  // namespace lab::tracker
