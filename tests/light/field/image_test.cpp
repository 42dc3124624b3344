#include "light/field/image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string_view>

#include "tests/support/light_samples.hpp"

namespace lab::light {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> bytesOf(std::string_view text) { return {text.begin(), text.end()}; }

TEST(LightImage, DigestEqualsTheExampleOfTheStandard) {
  EXPECT_EQ(sha256(bytesOf("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::vector<std::uint8_t> bytes = bytesOf("abc");
  std::size_t at = 0;
  EXPECT_EQ(sha256([&] {
              const std::size_t begin = at;
              at = std::min(at + 1, bytes.size());
              return std::span(bytes).subspan(begin, at - begin);
            }),
            sha256(bytes));
}

TEST(LightImage, LargerThanTheGridIsShrunkToFitWithItsProportions) {
  std::vector<std::uint8_t> halves;
  for (int i = 0; i < 640 * 240; ++i) halves.push_back(i % 640 < 320 ? 0 : 255);
  const DecodedImage dut = decodeImage(encodePng(640, 240, halves));
  ASSERT_TRUE(dut.image) << dut.error;
  EXPECT_EQ(dut.image->columns, 160);
  EXPECT_EQ(dut.image->rows, 60);
  EXPECT_NEAR(sample(*dut.image, 0.25, 0.5), 0, 1e-12);
  EXPECT_NEAR(sample(*dut.image, 0.75, 0.5), 1, 1e-12);
  EXPECT_NEAR(sample(*dut.image, 0.5, 0.5), 0.5, 1.0 / 255);
  EXPECT_EQ(dut.pixels, 640 * 240);
  EXPECT_LT(dut.image->grey.capacity(), 640U * 240U);  // a sequence may have a thousand images
}

TEST(LightImage, SamplesBetweenPixelCentresAndConstantBeyondThem) {
  const auto dut = makeImage(2, 2, {0, 102, 204, 255});
  EXPECT_NEAR(sample(*dut, 0.25, 0.75), 0, 1e-12);
  EXPECT_NEAR(sample(*dut, 0.5, 0.75), 0.2, 1e-12);
  EXPECT_NEAR(sample(*dut, 0.25, 0.5), 0.4, 1e-12);
  EXPECT_NEAR(sample(*dut, 0.0, 0.0), 0.8, 1e-12);
  EXPECT_NEAR(sample(*dut, 1.0, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(sample(*dut, 7.0, -7.0), 1.0, 1e-12);
}

TEST(LightImage, ThatIsInvalidNamesTheExpectedFormats) {
  const DecodedImage dut = decodeImage(bytesOf("light = 1"));
  EXPECT_FALSE(dut.image);
  EXPECT_THAT(dut.error, HasSubstr("not an image of a known format"));
}

TEST(LightImage, OfAFormatThatIsNotNeededIsRefused) {
  using namespace std::string_view_literals;
  const auto gif = "GIF89a\1\0\1\0\x80\0\0\0\0\0\xff\xff\xff,\0\0\0\0\1\0\1\0\0\2\2\x44\1\0;"sv;
  const auto tga = "\0\0\3\0\0\0\0\0\0\0\0\0\1\0\1\0\x08\0\x7f"sv;
  for (const std::string_view file : {gif, tga}) {
    const DecodedImage dut = decodeImage(bytesOf(file));
    EXPECT_FALSE(dut.image);
    EXPECT_EQ(dut.error, "is not an image of a known format (PNG, JPEG, BMP, PGM, PPM)");
  }
}

TEST(LightImage, ThatClaimsTooManyPixelsIsRefusedBeforeItIsDecoded) {
  using namespace std::string_view_literals;
  // stb after 2.27 reads the size of a PNG only if it has a beginning of its pixels, too.
  const auto png =
      "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x4e\x20\0\0\x4e\x20\x08\0\0\0\0\0\0\0\0"
      "\0\0\0\1IDAT\0\0\0\0\0"sv;
  const auto jpeg = "\xff\xd8\xff\xc0\0\x0b\x08\xff\xff\xff\xff\1\1\x11\0"sv;
  // The decoder itself, which asks for memory first, would name another reason.
  for (const std::string_view file : {png, jpeg, "P5 20000 20000 255\n"sv}) {
    const DecodedImage dut = decodeImage(bytesOf(file));
    EXPECT_FALSE(dut.image);
    EXPECT_EQ(dut.error, "has more than 100 million pixels");
  }
}

TEST(LightImage, ThatIsTruncatedIsRejected) {
  std::vector<std::uint8_t> png = encodePng(64, 64, std::vector<std::uint8_t>(64 * 64, 77));
  png.resize(png.size() / 2);
  const DecodedImage dut = decodeImage(png);
  EXPECT_FALSE(dut.image);
  EXPECT_THAT(dut.error, HasSubstr("cannot be decoded"));
}

TEST(LightImage, IsAttachedToTheLayersThatNameIt) {
  const auto image = makeImage(1, 1, {255});
  std::vector<Layer> layers(3);
  layers[1].kind = layers[2].kind = LayerKind::kImage;
  layers[1].image = image->sha256;
  layers[2].image = std::string(64, '0');

  attachImages(layers, {{image->sha256, image}});

  EXPECT_EQ(layers[0].pixels, nullptr);
  EXPECT_EQ(layers[1].pixels, image);
  EXPECT_EQ(layers[2].pixels, nullptr);
}

TEST(LightImage, PngNeedsOneValuePerPixel) {
  EXPECT_THROW((void)encodePng(3, 2, std::vector<std::uint8_t>(5)), std::invalid_argument);
}

}  // namespace
}  // namespace lab::light
