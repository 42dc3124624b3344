/// Grey pictures in memory: 8 bits per pixel, top row first; linear in light unless Imaging::gamma
/// differs from 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::optics {

/// A position in a picture: x right, y down, pixel centres at integers, (0, 0) the top left one.
struct Pixel {
  double x = 0;
  double y = 0;
};

/// A read-only view of a grey picture.
struct GreyView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  ///< [bytes] from one row to the next

  [[nodiscard]] const std::uint8_t* row(int y) const { return data + y * stride; }
  [[nodiscard]] bool contains(double x, double y, double margin = 0) const {
    return x >= margin && y >= margin && x <= width - 1 - margin && y <= height - 1 - margin;
  }
};

/// A grey picture that owns its pixels.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< height rows of width

  GreyImage() = default;
  GreyImage(int the_width, int the_height, std::uint8_t value = 0)
      : width(the_width),
        height(the_height),
        pixels(static_cast<std::size_t>(the_width) * static_cast<std::size_t>(the_height), value) {}

  [[nodiscard]] std::uint8_t* row(int y) {
    return pixels.data() + static_cast<std::ptrdiff_t>(y) * width;
  }
  [[nodiscard]] GreyView view() const { return {pixels.data(), width, height, width}; }
};

}  // namespace lab::optics
