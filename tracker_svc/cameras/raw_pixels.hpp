/// Converts the pixel formats of video devices to 8-bit grey.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "light/optics/grey_image.hpp"

namespace lab::cameras {

/// Memory layout of a picture.
struct RawLayout {
  std::uint32_t fourcc = 0;  ///< V4L2_PIX_FMT_...
  int width = 0;             ///< [px]
  int height = 0;            ///< [px]
  int stride = 0;            ///< [bytes] per row
  bool limited = false;      ///< luma is 16..235 instead of 0..255
};

/// The formats that greyOfRaw() supports, best first: uncompressed and not subsampled.
[[nodiscard]] std::span<const std::uint32_t> knownFormats();

/// Name of a format, "YUYV".
[[nodiscard]] std::string fourccName(std::uint32_t fourcc);

/// Whether the bytes of this format already are the grey picture.
[[nodiscard]] bool isGreyAlready(const RawLayout& layout);

/// Minimum size of a picture [bytes], 0 if it varies.
[[nodiscard]] std::size_t rawBytes(const RawLayout& layout);

/// Converts a picture to grey: luma for YUV formats, (R + 2 G + B) / 4 for Bayer patterns, by a
/// kernel that is symmetric about each pixel, so that nothing is displaced.
/// @return false if the bytes are no such picture
[[nodiscard]] bool greyOfRaw(const RawLayout& layout, std::span<const std::uint8_t> bytes,
                             optics::GreyImage& grey);

}  // namespace lab::cameras
