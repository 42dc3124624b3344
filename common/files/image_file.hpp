/// Images of light fields, read from files.
#pragma once

#include <filesystem>
#include <map>

#include "light/field/image.hpp"

namespace lab {

/// light::decodeImage() of a regular file; an error begins with the path.
[[nodiscard]] light::DecodedImage loadImage(const std::filesystem::path& path);

/// The images of one experiment or run. Each file is decoded once, however its path is written.
class ImageFiles {
 public:
  /// Pixels of all files together. Larger files are shrunk, so they cost only time: about 50 s.
  static constexpr double kMostPixels = 4e9;

  explicit ImageFiles(double most_pixels = kMostPixels) : most_pixels_(most_pixels) {}

  /// As loadImage(). After the most pixels, every further file gives an error.
  const light::DecodedImage& at(const std::filesystem::path& path);

 private:
  double most_pixels_;
  double pixels_ = 0;  ///< decoded so far
  std::map<std::filesystem::path, light::DecodedImage> loaded_;
};

}  // namespace lab
