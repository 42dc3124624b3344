/// Conversion of colour to the 8-bit grey that the tracker reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lab::cameras {

/// (R + 2 G + B) / 4, rounded: the weights of a Bayer sensor, the same for every source.
[[nodiscard]] constexpr std::uint8_t greyOf(unsigned red, unsigned green, unsigned blue) {
  return static_cast<std::uint8_t>((red + 2 * green + blue + 2) / 4);
}

/// greyOf() of `grey.size()` pixels of three bytes each.
inline void greyFromRgb(const std::uint8_t* rgb, std::span<std::uint8_t> grey) {
  for (std::uint8_t& pixel : grey) {
    pixel = greyOf(rgb[0], rgb[1], rgb[2]);
    rgb += 3;
  }
}

}  // namespace lab::cameras
