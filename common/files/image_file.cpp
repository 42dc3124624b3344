#include "common/files/image_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <system_error>

#include "common/files/file_text.hpp"

namespace lab {

light::DecodedImage loadImage(const std::filesystem::path& path) {
  const FileContent content = readRegularFile(path, file_kinds::kImage);
  if (!content.text) return {nullptr, path.string() + ": " + content.problem};
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(content.text->data());
  light::DecodedImage decoded = light::decodeImage({bytes, content.text->size()});
  if (!decoded.image) decoded.error = path.string() + " " + decoded.error;
  return decoded;
}

const light::DecodedImage& ImageFiles::at(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(path, error);
  const auto [place, is_new] = loaded_.try_emplace(error ? path : canonical);
  light::DecodedImage& decoded = place->second;
  if (!is_new) return decoded;
  if (pixels_ >= most_pixels_) {
    decoded.error = fmt::format(
        "{}: all images together have more than {:g} million pixels; shrink them to {} x {}, which "
        "is all that is shown",
        path.string(), most_pixels_ / 1e6, light::kMostColumns, light::kMostRows);
    return decoded;
  }
  decoded = loadImage(path);
  pixels_ += decoded.pixels;
  return decoded;
}

}  // namespace lab
