#include "tracker_svc/blobs/blob_split.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lab::detector {
namespace {

/// One pixel that is much darker than all others, as a speck of dust on a group of blobs: too few
/// pixels stand out for the centres of several blobs.
TEST(BlobSplit, AGroupWithOneDarkPixelIsNotSplit) {
  std::vector<ContrastPixel> pixels;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      ContrastPixel pixel;
      pixel.x = x;
      pixel.y = y;
      pixel.contrast = x == 10 && y == 10 ? 1 : 0.1;
      pixel.variance = 1e-4;
      pixels.push_back(pixel);
    }
  }
  for (const double long_axis : {5.0, 10.0}) {
    for (const int count : {2, 3, 5}) {
      static_cast<void>(splitBlob(pixels, count, {.long_axis = long_axis, .short_axis = 5}, {}));
    }
  }
  EXPECT_FALSE(splitBlob(pixels, 3, {.long_axis = 5, .short_axis = 5}, {}));
}

/// Discs of 160 pixels, as a microscope shows them: a part of their pixels is enough.
TEST(BlobSplit, LargeBlobsHaveTheirCentres) {
  constexpr double kRadius = 80;
  const std::vector<optics::Pixel> centres{{100, 100}, {100 + 2 * kRadius, 110}};
  std::vector<ContrastPixel> pixels;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 360; ++x) {
      double inside = -1e9;  // [px]
      for (const optics::Pixel& centre : centres) {
        inside = std::max(inside, kRadius - std::hypot(x - centre.x, y - centre.y));
      }
      pixels.push_back({double(x), double(y), std::clamp(inside + 0.5, 0.0, 1.0), 1e-4});
    }
  }
  const auto split = splitBlob(pixels, 2, {.long_axis = kRadius, .short_axis = kRadius}, {});
  ASSERT_TRUE(split);
  for (const BlobPart& part : split->parts) {
    const optics::Pixel& truth = centres[part.centre.x < 180 ? 0 : 1];
    EXPECT_NEAR(part.centre.x, truth.x, 0.3);
    EXPECT_NEAR(part.centre.y, truth.y, 0.3);
  }
}

}  // namespace
}  // namespace lab::detector
