#include "tracker_svc/cameras/raw_pixels.hpp"

#include <linux/videodev2.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <type_traits>

namespace lab::cameras {
namespace {

constexpr std::array<std::uint32_t, 14> kKnown = {
    V4L2_PIX_FMT_GREY,   V4L2_PIX_FMT_Y10,    V4L2_PIX_FMT_Y12,    V4L2_PIX_FMT_Y16,
    V4L2_PIX_FMT_SRGGB8, V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_SGBRG8, V4L2_PIX_FMT_SBGGR8,
    V4L2_PIX_FMT_YUYV,   V4L2_PIX_FMT_UYVY,   V4L2_PIX_FMT_NV12,   V4L2_PIX_FMT_NV21,
    V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_MJPEG};

/// Bits of a two-byte grey sample; 0 for one-byte samples.
int deepBits(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_Y10:
      return 10;
    case V4L2_PIX_FMT_Y12:
      return 12;
    case V4L2_PIX_FMT_Y16:
      return 16;
    default:
      return 0;
  }
}

bool isBayer(std::uint32_t fourcc) {
  return fourcc == V4L2_PIX_FMT_SRGGB8 || fourcc == V4L2_PIX_FMT_SGRBG8 ||
         fourcc == V4L2_PIX_FMT_SGBRG8 || fourcc == V4L2_PIX_FMT_SBGGR8;
}

/// Distance between luma samples, and offset of the first [bytes].
struct Luma {
  int step = 1;
  int first = 0;
};

Luma lumaOf(std::uint32_t fourcc) {
  if (fourcc == V4L2_PIX_FMT_YUYV) return {2, 0};
  if (fourcc == V4L2_PIX_FMT_UYVY) return {2, 1};
  return {};
}

/// Expands 16..235 to 0..255.
constexpr std::array<std::uint8_t, 256> kExpanded = [] {
  std::array<std::uint8_t, 256> table{};
  for (int i = 0; i < 256; ++i) {
    const int full = ((i - 16) * 255 + 109) / 219;
    table[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(i <= 16 ? 0 : std::min(full, 255));
  }
  return table;
}();

void copyLuma(const RawLayout& layout, const std::uint8_t* bytes, optics::GreyImage& grey) {
  const Luma luma = lumaOf(layout.fourcc);
  for (int y = 0; y < layout.height; ++y) {
    const std::uint8_t* from = bytes + std::ptrdiff_t{y} * layout.stride + luma.first;
    std::uint8_t* to = grey.row(y);
    for (int x = 0; x < layout.width; ++x) to[x] = from[x * luma.step];
    if (layout.limited) {
      for (int x = 0; x < layout.width; ++x) to[x] = kExpanded[to[x]];
    }
  }
}

void copyDeep(const RawLayout& layout, const std::uint8_t* bytes, optics::GreyImage& grey) {
  const int shift = deepBits(layout.fourcc) - 8;
  const int half = 1 << (shift - 1);
  for (int y = 0; y < layout.height; ++y) {
    const std::uint8_t* from = bytes + std::ptrdiff_t{y} * layout.stride;
    std::uint8_t* to = grey.row(y);
    for (int x = 0; x < layout.width; ++x) {
      const int sample = from[2 * x] + 256 * from[2 * x + 1];
      to[x] = static_cast<std::uint8_t>(std::min((sample + half) >> shift, 255));
    }
  }
}

/// Kernel 1 2 1, 2 4 2, 1 2 1: at every position a quarter of its weight is on red, half on green
/// and a quarter on blue. Mirrored at the border, which preserves the colour pattern.
void mixBayer(const RawLayout& layout, const std::uint8_t* bytes, optics::GreyImage& grey) {
  const int width = layout.width;
  std::vector<int> sums(static_cast<std::size_t>(width) + 2);
  const auto row = [&](int y) {
    const int mirrored = y < 0 ? 1 : y >= layout.height ? layout.height - 2 : y;
    return bytes + std::ptrdiff_t{mirrored} * layout.stride;
  };
  for (int y = 0; y < layout.height; ++y) {
    const std::uint8_t* above = row(y - 1);
    const std::uint8_t* here = row(y);
    const std::uint8_t* below = row(y + 1);
    for (int x = 0; x < width; ++x) {
      sums[static_cast<std::size_t>(x) + 1] = above[x] + 2 * here[x] + below[x];
    }
    sums.front() = sums[2];
    sums.back() = sums[static_cast<std::size_t>(width) - 1];
    std::uint8_t* to = grey.row(y);
    for (int x = 0; x < width; ++x) {
      const int* three = sums.data() + x;
      to[x] = static_cast<std::uint8_t>((three[0] + 2 * three[1] + three[2] + 8) / 16);
    }
  }
}

struct CloseDecoder {
  void operator()(void* decoder) const { tjDestroy(decoder); }
};

// USB cameras may omit the Huffman tables; libjpeg-turbo then uses those of ITU-T T.81, annex K.3.
bool decodeJpeg(const RawLayout& layout, std::span<const std::uint8_t> bytes,
                optics::GreyImage& grey) {
  const std::unique_ptr<std::remove_pointer_t<tjhandle>, CloseDecoder> decoder(tjInitDecompress());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (!decoder || tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height,
                                      &subsampling, &colours) != 0) {
    return false;
  }
  if (width != layout.width || height != layout.height) return false;
  if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), grey.pixels.data(), width, 0, height,
                    TJPF_GRAY, TJFLAG_ACCURATEDCT) == 0) {
    return true;
  }
  // Padding between frames is harmless; every other warning means damaged data.
  const std::string_view warning = tjGetErrorStr2(decoder.get());
  return tjGetErrorCode(decoder.get()) == TJERR_WARNING &&
         warning.find("extraneous bytes") != std::string_view::npos;
}

}  // namespace

std::span<const std::uint32_t> knownFormats() { return kKnown; }

std::string fourccName(std::uint32_t fourcc) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const auto letter = static_cast<char>((fourcc >> (8 * i)) & 0x7F);
    name += letter >= ' ' ? letter : '?';
  }
  while (!name.empty() && name.back() == ' ') name.pop_back();
  return name;
}

bool isGreyAlready(const RawLayout& layout) {
  const bool one_plane = layout.fourcc == V4L2_PIX_FMT_GREY || layout.fourcc == V4L2_PIX_FMT_NV12 ||
                         layout.fourcc == V4L2_PIX_FMT_NV21 || layout.fourcc == V4L2_PIX_FMT_YUV420;
  return one_plane && !layout.limited;
}

std::size_t rawBytes(const RawLayout& layout) {
  if (layout.fourcc == V4L2_PIX_FMT_MJPEG) return 0;
  const int sample = deepBits(layout.fourcc) > 0 ? 2 : lumaOf(layout.fourcc).step;
  const auto rows = static_cast<std::size_t>(layout.height - 1);
  return rows * static_cast<std::size_t>(layout.stride) +
         static_cast<std::size_t>(layout.width * sample);
}

bool greyOfRaw(const RawLayout& layout, std::span<const std::uint8_t> bytes,
               optics::GreyImage& grey) {
  if (bytes.size() < rawBytes(layout) || layout.width < 3 || layout.height < 3) return false;
  if (grey.width != layout.width || grey.height != layout.height) {
    grey = optics::GreyImage(layout.width, layout.height);
  }
  if (layout.fourcc == V4L2_PIX_FMT_MJPEG) return decodeJpeg(layout, bytes, grey);
  if (deepBits(layout.fourcc) > 0) {
    copyDeep(layout, bytes.data(), grey);
  } else if (isBayer(layout.fourcc)) {
    mixBayer(layout, bytes.data(), grey);
  } else {
    copyLuma(layout, bytes.data(), grey);
  }
  return true;
}

}  // namespace lab::cameras
