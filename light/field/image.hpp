/// Pictures in light fields: grey images small enough for messages, identified by the SHA-256 of
/// their file.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "light/field/layer.hpp"

namespace lab::light {

inline constexpr int kMostColumns = 160;
inline constexpr int kMostRows = 120;

/// Grey values as the projector shows them: 0 dark, 255 white, linear in intensity.
struct Image {
  int columns = 0;                 ///< at most kMostColumns
  int rows = 0;                    ///< at most kMostRows
  std::vector<std::uint8_t> grey;  ///< rows x columns, the top row first
  std::string sha256;              ///< of the file's bytes
};

/// Grey in 0..1 at `across` (0 left edge .. 1 right edge) and `up` (0 bottom .. 1 top), bilinear
/// between pixel centres and constant outside the outermost centres.
[[nodiscard]] double sample(const Image& image, double across, double up);

/// SHA-256 of the bytes in 64 lower-case hexadecimal digits (FIPS 180-4, by libmd).
[[nodiscard]] std::string sha256(std::span<const std::uint8_t> bytes);

/// The same of bytes that come in parts.
/// @param next gives the next part; an empty one is the end
[[nodiscard]] std::string sha256(const std::function<std::span<const std::uint8_t>()>& next);

/// An image, or the reason why there is none.
struct DecodedImage {
  std::shared_ptr<const Image> image;
  std::string error;
  double pixels = 0;  ///< number of pixels in the file, if it was decoded
};

/// Decodes PNG, JPEG, BMP, PGM and PPM of at most 64 MB and 100 million pixels to 8-bit grey. An
/// image above 160 x 120 is shrunk to fit, keeping its proportions to the nearest pixel, by a
/// triangle filter.
[[nodiscard]] DecodedImage decodeImage(std::span<const std::uint8_t> file);

/// Images by their SHA-256.
using ImageStore = std::map<std::string, std::shared_ptr<const Image>>;

/// Sets the pixels of every image layer in the store; others keep none.
void attachImages(std::vector<Layer>& layers, const ImageStore& store);

/// An 8-bit grey PNG file.
/// @param grey columns x rows values, the top row first.
/// @throws std::invalid_argument if their number is not columns * rows
[[nodiscard]] std::vector<std::uint8_t> encodePng(int columns, int rows,
                                                  std::span<const std::uint8_t> grey);

}  // namespace lab::light
