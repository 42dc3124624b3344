#include "light/photometry/camera_response.hpp"

#include <gtest/gtest.h>

namespace lab::optics {
namespace {

TEST(CameraResponse, IsThePowerOfTheGreyValue) {
  const CameraResponse response(2.2);
  EXPECT_DOUBLE_EQ(response.light(0), 0);
  EXPECT_DOUBLE_EQ(response.light(255), 255);
  // (128 / 255)^2.2
  EXPECT_NEAR(response.light(128), 255 * 0.21952, 1e-3);
}

TEST(CameraResponse, KeepsBlackAndFullScale) {
  const CameraResponse response(2.2, 16);
  EXPECT_EQ(response.light(7), 7);
  EXPECT_EQ(response.light(16), 16);
  EXPECT_DOUBLE_EQ(response.light(255), 255);
}

TEST(CameraResponse, IsInvertible) {
  const CameraResponse response(1.8, 5);
  for (int step = 0; step < 256; ++step)
    EXPECT_NEAR(response.grey(response.light(step)), step, 1e-9);
}

TEST(CameraResponse, ReturnsALinearPictureUnchanged) {
  const GreyImage picture(4, 3, 100);
  EXPECT_EQ(CameraResponse().linear(picture.view()).data, picture.pixels.data());
}

TEST(CameraResponse, HandlesAPictureWithinALargerBuffer) {
  GreyImage whole(8, 5, 255);
  const GreyView part{whole.row(1) + 2, 3, 2, 8};
  whole.row(2)[4] = 128;
  whole.row(2)[5] = 1;  // outside the part
  CameraResponse response(2.2);
  const GreyView read = response.linear(part);
  ASSERT_EQ(read.width, 3);
  ASSERT_EQ(read.height, 2);
  EXPECT_EQ(read.row(1)[2], 56);
  EXPECT_EQ(read.row(1)[1], 255);
  EXPECT_EQ(read.row(0)[2], 255);
}

}  // namespace
}  // namespace lab::optics
