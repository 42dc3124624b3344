#include "light/optics/rgb_image.hpp"

#include <stb/stb_image_write.h>

#include <algorithm>
#include <stdexcept>

namespace lab::optics {
namespace {

constexpr int kGap = 4;               // [px] between tiles
constexpr std::uint8_t kGround = 24;  // [DN] background

void append(void* context, void* data, int size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  auto& out = *static_cast<std::vector<std::uint8_t>*>(context);
  out.insert(out.end(), bytes, bytes + size);
}

}  // namespace

std::vector<std::uint8_t> pngBytes(const RgbImage& image) {
  std::vector<std::uint8_t> bytes;
  if (image.pixels.empty() || stbi_write_png_to_func(append, &bytes, image.width, image.height, 3,
                                                     image.pixels.data(), image.width * 3) == 0) {
    throw std::runtime_error("a picture cannot be written as PNG");
  }
  return bytes;
}

std::vector<std::uint8_t> jpegBytes(const RgbImage& image, int quality) {
  std::vector<std::uint8_t> bytes;
  if (image.pixels.empty() || stbi_write_jpg_to_func(append, &bytes, image.width, image.height, 3,
                                                     image.pixels.data(), quality) == 0) {
    throw std::runtime_error("a picture cannot be written as JPEG");
  }
  return bytes;
}

RgbImage contactSheet(const std::vector<RgbImage>& tiles, int columns) {
  if (tiles.empty()) return {};
  const int count = static_cast<int>(tiles.size());
  const int across = std::clamp(columns, 1, count);
  const int down = (count + across - 1) / across;
  const int width = tiles.front().width;
  const int height = tiles.front().height;
  RgbImage sheet(across * width + (across - 1) * kGap, down * height + (down - 1) * kGap);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), kGround);
  for (int i = 0; i < count; ++i) {
    const RgbImage& tile = tiles[static_cast<std::size_t>(i)];
    const int left = i % across * (width + kGap);
    const int top = i / across * (height + kGap);
    for (int y = 0; y < std::min(height, tile.height); ++y) {
      std::copy_n(tile.at(0, y), 3 * std::min(width, tile.width), sheet.at(left, top + y));
    }
  }
  return sheet;
}

}  // namespace lab::optics
