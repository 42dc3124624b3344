#include "light/optics/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "light/optics/bitmap_font.hpp"

namespace lab::optics {
namespace {

std::uint8_t mixed(std::uint8_t below, std::uint8_t above, double share) {
  return static_cast<std::uint8_t>(std::lround(below + share * (above - below)));
}

}  // namespace

void Canvas::blend(int x, int y, Colour colour, double share) {
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  std::uint8_t* pixel = image_.at(x, y);
  pixel[0] = mixed(pixel[0], colour.red, share);
  pixel[1] = mixed(pixel[1], colour.green, share);
  pixel[2] = mixed(pixel[2], colour.blue, share);
}

void Canvas::line(Pixel from, Pixel to, Colour colour, double thickness) {
  if (!std::isfinite(from.x + from.y + to.x + to.y)) return;
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length2 = dx * dx + dy * dy;
  const double reach = thickness / 2 + 1;
  // Limited to the picture, however long the line is.
  const auto inside = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, size - 1.0));
  };
  const int left = inside(std::floor(std::min(from.x, to.x) - reach), image_.width);
  const int right = inside(std::ceil(std::max(from.x, to.x) + reach), image_.width);
  const int top = inside(std::floor(std::min(from.y, to.y) - reach), image_.height);
  const int bottom = inside(std::ceil(std::max(from.y, to.y) + reach), image_.height);
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double px = x - from.x;
      const double py = y - from.y;
      const double along = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0;
      const double distance = std::hypot(px - along * dx, py - along * dy);
      const double share = std::clamp(thickness / 2 + 0.5 - distance, 0.0, 1.0);
      if (share > 0) blend(x, y, colour, share);
    }
  }
}

void Canvas::text(int x, int y, std::string_view text, Colour colour, int size) {
  forEachGlyphPixel(text, x, y, size, [&](int column, int row) { blend(column, row, colour, 1); });
}

void Canvas::shade(int x, int y, int width, int height) {
  constexpr double kShare = 0.65;
  for (int row = std::max(0, y); row < std::min(y + height, image_.height); ++row) {
    for (int column = std::max(0, x); column < std::min(x + width, image_.width); ++column) {
      blend(column, row, {}, kShare);
    }
  }
}

}  // namespace lab::optics
