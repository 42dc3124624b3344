/// The pixels of video devices as 8-bit grey.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "light/optics/grey_image.hpp"

namespace lab::cameras {

/// How a device lays out a picture.
struct RawLayout {
  std::uint32_t fourcc = 0;  ///< V4L2_PIX_FMT_...
  int width = 0;             ///< [px]
  int height = 0;            ///< [px]
  int stride = 0;            ///< bytes a row
  bool limited = false;      ///< luma is 16..235 instead of 0..255
};

/// The formats that greyOfRaw() knows, best first: what is not compressed and not subsampled.
[[nodiscard]] std::span<const std::uint32_t> knownFormats();

/// "YUYV".
[[nodiscard]] std::string fourccName(std::uint32_t fourcc);

/// Whether the bytes of this format are the grey picture themselves.
[[nodiscard]] bool isGreyAlready(const RawLayout& layout);

/// How many bytes a whole picture has at least, 0: that varies.
[[nodiscard]] std::size_t rawBytes(const RawLayout& layout);

/// Turns a picture into grey: luma where the device sends luma, (R + 2 G + B) / 4 of Bayer pixels,
/// which a kernel that is symmetric about each pixel takes from its neighbours, so that nothing is
/// displaced. @return false when the bytes are no such picture.
[[nodiscard]] bool greyOfRaw(const RawLayout& layout, std::span<const std::uint8_t> bytes,
                             optics::GreyImage& grey);

}  // namespace lab::cameras
