#include "tracker_svc/cameras/raw_pixels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <array>

namespace lab::cameras {
namespace {

using testing::Each;
using testing::ElementsAre;

/// 3 rows of 4 pixels by default.
RawLayout layoutOf(std::uint32_t fourcc, int stride, int width = 4, int height = 3) {
  return {fourcc, width, height, stride, false};
}

std::vector<std::uint8_t> greyBytes(const RawLayout& layout,
                                    const std::vector<std::uint8_t>& bytes) {
  optics::GreyImage grey;
  EXPECT_TRUE(greyOfRaw(layout, bytes, grey));
  return grey.pixels;
}

TEST(RawPixels, LumaIsExtractedFromYuvFormats) {
  const std::vector<std::uint8_t> row = {10, 128, 20, 128, 30, 128, 40, 128, 99, 99};
  std::vector<std::uint8_t> yuyv;
  std::vector<std::uint8_t> uyvy;
  for (int y = 0; y < 3; ++y) {
    yuyv.insert(yuyv.end(), row.begin(), row.end());
    uyvy.push_back(77);
    uyvy.insert(uyvy.end(), row.begin(), row.end() - 1);
  }

  EXPECT_THAT(greyBytes(layoutOf(V4L2_PIX_FMT_YUYV, 10), yuyv),
              ElementsAre(10, 20, 30, 40, 10, 20, 30, 40, 10, 20, 30, 40));
  EXPECT_EQ(greyBytes(layoutOf(V4L2_PIX_FMT_UYVY, 10), uyvy),
            greyBytes(layoutOf(V4L2_PIX_FMT_YUYV, 10), yuyv));
}

TEST(RawPixels, DeepGreyIsRounded) {
  // 10 bits: 0, 5, 6, 1023 of 1023; 16 bits: 0x00ff, 0x1280, 0x127f, 0xffff
  const std::vector<std::uint8_t> ten = {0, 0, 5, 0, 6, 0, 0xff, 3};
  const std::vector<std::uint8_t> sixteen = {0xff, 0, 0x80, 0x12, 0x7f, 0x12, 0xff, 0xff};
  const auto three = [](const std::vector<std::uint8_t>& row) {
    std::vector<std::uint8_t> all;
    for (int y = 0; y < 3; ++y) all.insert(all.end(), row.begin(), row.end());
    return all;
  };

  const auto first = greyBytes(layoutOf(V4L2_PIX_FMT_Y10, 8), three(ten));
  const auto second = greyBytes(layoutOf(V4L2_PIX_FMT_Y16, 8), three(sixteen));

  EXPECT_THAT(std::vector(first.begin(), first.begin() + 4), ElementsAre(0, 1, 2, 255));
  EXPECT_THAT(std::vector(second.begin(), second.begin() + 4), ElementsAre(1, 0x13, 0x12, 255));
}

/// A uniformly coloured Bayer picture.
std::vector<std::uint8_t> bayer(std::uint32_t fourcc, int width, int height, int red, int green,
                                int blue) {
  const bool red_first = fourcc == V4L2_PIX_FMT_SRGGB8 || fourcc == V4L2_PIX_FMT_SGRBG8;
  const bool green_first = fourcc == V4L2_PIX_FMT_SGRBG8 || fourcc == V4L2_PIX_FMT_SGBRG8;
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_green = ((x + y) % 2 == 0) == green_first;
      const bool red_row = (y % 2 == 0) == red_first;
      bytes.push_back(static_cast<std::uint8_t>(is_green ? green : red_row ? red : blue));
    }
  }
  return bytes;
}

TEST(RawPixels, BayerColoursAreMixedEquallyAtEveryPosition) {
  for (const std::uint32_t fourcc :
       {V4L2_PIX_FMT_SRGGB8, V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_SGBRG8, V4L2_PIX_FMT_SBGGR8}) {
    SCOPED_TRACE(fourccName(fourcc));
    EXPECT_THAT(greyBytes(layoutOf(fourcc, 6, 6, 5), bayer(fourcc, 6, 5, 200, 100, 40)),
                Each(110));  // (200 + 2 * 100 + 40) / 4
  }
}

TEST(RawPixels, BayerConversionDisplacesNothing) {
  // A linear gradient of grey is preserved, except at the border.
  std::vector<std::uint8_t> slope;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 8; ++x) slope.push_back(static_cast<std::uint8_t>(20 * x + 10 * y));
  }

  const auto grey = greyBytes(layoutOf(V4L2_PIX_FMT_SGRBG8, 8, 8, 5), slope);

  for (int y = 1; y < 4; ++y) {
    for (int x = 1; x < 7; ++x)
      EXPECT_EQ(grey[static_cast<std::size_t>(8 * y + x)], 20 * x + 10 * y);
  }
}

TEST(RawPixels, LimitedRangeIsExpanded) {
  RawLayout layout = layoutOf(V4L2_PIX_FMT_NV12, 4);
  layout.limited = true;
  const std::vector<std::uint8_t> bytes = {0, 16, 17, 126, 235, 255, 16, 16, 16, 16, 16, 16};

  const auto grey = greyBytes(layout, bytes);

  EXPECT_THAT(std::vector(grey.begin(), grey.begin() + 6), ElementsAre(0, 0, 1, 128, 255, 255));
  EXPECT_FALSE(isGreyAlready(layout));
  EXPECT_TRUE(isGreyAlready(layoutOf(V4L2_PIX_FMT_NV12, 4)));
}

TEST(RawPixels, TooFewBytesAreRejected) {
  optics::GreyImage grey;
  EXPECT_FALSE(greyOfRaw(layoutOf(V4L2_PIX_FMT_GREY, 4), std::vector<std::uint8_t>(11), grey));
  EXPECT_FALSE(greyOfRaw(layoutOf(V4L2_PIX_FMT_MJPEG, 0), std::vector<std::uint8_t>(500), grey));
}

std::vector<std::uint8_t> jpegOf(int width, int height) {
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < width * height * 3; ++i) {
    pixels.push_back(static_cast<std::uint8_t>((i * 7919) >> 3));
  }
  std::vector<std::uint8_t> jpeg;
  stbi_write_jpg_to_func(
      [](void* context, void* data, int size) {
        auto& out = *static_cast<std::vector<std::uint8_t>*>(context);
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        out.insert(out.end(), bytes, bytes + size);
      },
      &jpeg, width, height, 3, pixels.data(), 80);
  return jpeg;
}

TEST(RawPixels, JpegsWithoutHuffmanTablesAreDecodedWithTheStandardOnes) {
  // stb_image_write uses the standard's tables; without them the decoded picture must be the same.
  const std::vector<std::uint8_t> whole = jpegOf(40, 24);
  std::vector<std::uint8_t> bare = whole;
  const std::array<std::uint8_t, 2> mark = {0xff, 0xc4};
  const auto at = std::search(bare.begin(), bare.end(), mark.begin(), mark.end());
  ASSERT_NE(at, bare.end());
  bare.erase(at, at + 2 + at[2] * 256 + at[3]);
  const RawLayout layout = layoutOf(V4L2_PIX_FMT_MJPEG, 0, 40, 24);

  EXPECT_EQ(greyBytes(layout, bare), greyBytes(layout, whole));
}

TEST(RawPixels, JpegsOfAnotherSizeAreRejected) {
  optics::GreyImage grey;
  EXPECT_FALSE(greyOfRaw(layoutOf(V4L2_PIX_FMT_MJPEG, 0, 32, 24), jpegOf(40, 24), grey));
}

TEST(RawPixels, FormatsHaveNames) {
  EXPECT_EQ(fourccName(V4L2_PIX_FMT_YUYV), "YUYV");
  EXPECT_EQ(fourccName(V4L2_PIX_FMT_Y16), "Y16");
}

}  // namespace
}  // namespace lab::cameras
