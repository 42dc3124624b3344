/// RGB pictures for display.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::optics {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// Top row first, three bytes per pixel: red, green, blue.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  RgbImage() = default;
  RgbImage(int the_width, int the_height)
      : width(the_width),
        height(the_height),
        pixels(static_cast<std::size_t>(the_width) * static_cast<std::size_t>(the_height) * 3) {}

  /// The first byte of a pixel inside the image.
  [[nodiscard]] std::uint8_t* at(int x, int y) {
    return pixels.data() + (static_cast<std::ptrdiff_t>(y) * width + x) * 3;
  }
  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return pixels.data() + (static_cast<std::ptrdiff_t>(y) * width + x) * 3;
  }
};

/// Encodes a PNG file. @throws std::runtime_error for an empty image or without memory
[[nodiscard]] std::vector<std::uint8_t> pngBytes(const RgbImage& image);

/// Encodes a JPEG file. @param quality 1..100. @throws as pngBytes()
[[nodiscard]] std::vector<std::uint8_t> jpegBytes(const RgbImage& image, int quality = 80);

/// Images of equal size in a grid, row by row, on a dark background; empty if there are none.
[[nodiscard]] RgbImage contactSheet(const std::vector<RgbImage>& tiles, int columns);

}  // namespace lab::optics
