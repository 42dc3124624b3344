#include "light/field/image.hpp"

#include <sha256.h>
#include <stb/stb_image.h>
#include <stb/stb_image_resize.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace lab::light {

namespace {

constexpr std::size_t kMostFileBytes = 64U << 20U;
constexpr double kMostPixels = 1e8;

/// How files of PNG, JPEG, BMP, PGM and PPM begin. stb also has a decoder of TGA, for pictures of
/// cameras, and that format has no such mark.
constexpr std::array<std::string_view, 5> kBeginnings{"\x89PNG", "\xff\xd8", "BM", "P5", "P6"};

bool hasKnownBeginning(std::span<const std::uint8_t> file) {
  return std::ranges::any_of(kBeginnings, [&](std::string_view beginning) {
    return file.size() >= beginning.size() &&
           std::equal(beginning.begin(), beginning.end(), file.begin(),
                      [](char mark, std::uint8_t byte) {
                        return static_cast<std::uint8_t>(mark) == byte;
                      });
  });
}

struct StbFree {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

/// Indices of two adjacent pixel centres among `count`, and the weight of the second, for a place
/// in 0..1.
struct Neighbours {
  int first;
  int second;
  double share;
};

Neighbours neighbours(double place, int count) {
  const double centre = std::clamp(place * count - 0.5, 0.0, static_cast<double>(count - 1));
  const int first = static_cast<int>(centre);
  return {first, std::min(first + 1, count - 1), centre - first};
}

}  // namespace

double sample(const Image& image, double across, double up) {
  const Neighbours x = neighbours(across, image.columns);
  const Neighbours y = neighbours(1 - up, image.rows);
  const auto row = [&](int number) {
    const std::uint8_t* grey = image.grey.data() + std::ptrdiff_t{number} * image.columns;
    return grey[x.first] + x.share * (grey[x.second] - grey[x.first]);
  };
  const double upper = row(y.first);
  return (upper + y.share * (row(y.second) - upper)) / 255;
}

std::string sha256(std::span<const std::uint8_t> bytes) {
  char digits[SHA256_DIGEST_STRING_LENGTH];
  SHA256Data(bytes.data(), bytes.size(), digits);
  return digits;
}

std::string sha256(const std::function<std::span<const std::uint8_t>()>& next) {
  SHA2_CTX context;
  SHA256Init(&context);
  for (auto part = next(); !part.empty(); part = next()) {
    SHA256Update(&context, part.data(), part.size());
  }
  char digits[SHA256_DIGEST_STRING_LENGTH];
  SHA256End(&context, digits);
  return digits;
}

DecodedImage decodeImage(std::span<const std::uint8_t> file) {
  if (file.size() > kMostFileBytes) return {nullptr, "is above 64 MB"};
  const int length = static_cast<int>(file.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  if (!hasKnownBeginning(file) ||
      stbi_info_from_memory(file.data(), length, &width, &height, &channels) == 0) {
    return {nullptr, "is not an image of a known format (PNG, JPEG, BMP, PGM, PPM)"};
  }
  if (static_cast<double>(width) * height > kMostPixels) {
    return {nullptr, "has more than 100 million pixels"};
  }
  const std::unique_ptr<stbi_uc, StbFree> decoded(
      stbi_load_from_memory(file.data(), length, &width, &height, &channels, 1));
  if (!decoded) return {nullptr, std::string("cannot be decoded: ") + stbi_failure_reason()};

  auto image = std::make_shared<Image>();
  const double scale = std::min(
      {1.0, static_cast<double>(kMostColumns) / width, static_cast<double>(kMostRows) / height});
  image->columns = std::max(1, static_cast<int>(std::lround(width * scale)));
  image->rows = std::max(1, static_cast<int>(std::lround(height * scale)));
  image->sha256 = sha256(file);
  if (scale >= 1) {
    image->grey.assign(decoded.get(), decoded.get() + static_cast<std::ptrdiff_t>(width) * height);
  } else {
    image->grey.resize(static_cast<std::size_t>(image->columns) *
                       static_cast<std::size_t>(image->rows));
    // The triangle filter does not overshoot, so dark areas beside a bright edge stay dark.
    if (stbir_resize_uint8_generic(decoded.get(), width, height, 0, image->grey.data(),
                                   image->columns, image->rows, 0, 1, STBIR_ALPHA_CHANNEL_NONE, 0,
                                   STBIR_EDGE_CLAMP, STBIR_FILTER_TRIANGLE, STBIR_COLORSPACE_LINEAR,
                                   nullptr) == 0) {
      return {nullptr, "cannot be shrunk to 160 x 120: out of memory"};
    }
  }
  return {std::move(image), {}, static_cast<double>(width) * height};
}

void attachImages(std::vector<Layer>& layers, const ImageStore& store) {
  for (Layer& layer : layers) {
    if (layer.kind != LayerKind::kImage) continue;
    const auto found = store.find(layer.image);
    if (found != store.end()) layer.pixels = found->second;
  }
}

std::vector<std::uint8_t> encodePng(int columns, int rows, std::span<const std::uint8_t> grey) {
  if (columns < 1 || rows < 1 ||
      grey.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {
    throw std::invalid_argument("encodePng: the number of values is not columns * rows");
  }
  std::vector<std::uint8_t> png;
  const auto append = [](void* context, void* data, int size) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    auto& out = *static_cast<std::vector<std::uint8_t>*>(context);
    out.insert(out.end(), bytes, bytes + size);
  };
  stbi_write_png_to_func(append, &png, columns, rows, 1, grey.data(), columns);
  return png;
}

}  // namespace lab::light
