/// Lines and text on an RGB picture.
#pragma once

#include <string_view>

#include "light/optics/bitmap_font.hpp"
#include "light/optics/grey_image.hpp"
#include "light/optics/rgb_image.hpp"

namespace lab::optics {

/// Draws on a picture; clips at its edges.
class Canvas {
 public:
  explicit Canvas(RgbImage& image) : image_(image) {}

  /// An antialiased line of this thickness [px].
  void line(Pixel from, Pixel to, Colour colour, double thickness = 1);

  /// Text with its top left corner at (x, y), glyphs of 5 x 7 px times `size`. Lower case is drawn
  /// as capitals, signs without a glyph as a box.
  void text(int x, int y, std::string_view text, Colour colour, int size = 1);

  /// Darkens a rectangle, as a background for text.
  void shade(int x, int y, int width, int height);

 private:
  void blend(int x, int y, Colour colour, double share);

  RgbImage& image_;
};

}  // namespace lab::optics
