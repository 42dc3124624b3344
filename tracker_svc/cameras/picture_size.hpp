/// The largest pictures that are read.
#pragma once

#include <cstdint>
#include <string>

namespace lab::cameras {

/// A file of 300 bytes can state any size, and memory is taken for it. python/active_lab/films.py
/// has the same limit.
inline constexpr std::int64_t kMostPicturePixels = 200'000'000;

/// What is wrong with the size of a picture; empty: nothing.
[[nodiscard]] inline std::string pictureSizeProblem(int width, int height) {
  if (std::int64_t{width} * height <= kMostPicturePixels) return {};
  return "found " + std::to_string(width) + " x " + std::to_string(height) +
         " pixels, expected at most 200 million: make it smaller with ffmpeg (-vf scale=W:H)";
}

}  // namespace lab::cameras
