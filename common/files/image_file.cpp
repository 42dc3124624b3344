#include "common/files/image_file.hpp"

#include <cstdint>

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

}  // namespace lab
