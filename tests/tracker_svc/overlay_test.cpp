#include "tracker_svc/overlay.hpp"

#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "light/optics/canvas.hpp"
#include "light/optics/simulated_camera.hpp"

namespace lab::tracker {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

bool isRed(const std::uint8_t* p) { return p[0] > 150 && p[1] < 130 && p[2] < 130; }
bool isGreen(const std::uint8_t* p) { return p[1] > 150 && p[0] < 130 && p[2] < 160; }
bool isOrange(const std::uint8_t* p) { return p[0] > 180 && p[1] > 110 && p[2] < 100; }

struct Bench {
  optics::CameraModel camera{optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9)};
  optics::CapGeometry cap;
  optics::GreyImage picture{kWidth, kHeight, 180};

  [[nodiscard]] Mark mark(double x, double y, double theta) const {
    Mark mark;
    mark.pose.x = x;
    mark.pose.y = y;
    mark.pose.theta = theta;
    mark.pose.quality = 0.9F;
    mark.pose.used = detector::kUsedBig | detector::kUsedSmall;
    return mark;
  }

  /// Whether a pixel within one of this place of the cap satisfies the predicate.
  [[nodiscard]] bool near(const optics::RgbImage& image, double x, double y,
                          bool (*is)(const std::uint8_t*)) const {
    const optics::Pixel at = camera.project(x, y, cap.height);
    const double scale = static_cast<double>(image.width) / kWidth;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (is(image.at(static_cast<int>(at.x * scale) + dx,
                        static_cast<int>(at.y * scale) + dy))) {
          return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] optics::RgbImage draw(std::span<const Mark> marks,
                                      std::span<const detector::Rejection> rejected = {},
                                      int width = 0) const {
    optics::GreyImage copy = picture;
    return overlay({.picture = copy.view(),
                    .marks = marks,
                    .rejected = rejected,
                    .caption = {},
                    .width = width},
                   camera, cap);
  }
};

TEST(Overlay, OutlinesTheCapWhereItIs) {
  const Bench bench;
  const std::vector marks{bench.mark(0.3, 0.6, 0)};

  const optics::RgbImage image = bench.draw(marks);

  EXPECT_TRUE(bench.near(image, 0.3 + bench.cap.cap_radius, 0.6, isGreen));
  EXPECT_TRUE(bench.near(image, 0.3, 0.6 - bench.cap.cap_radius, isGreen));
  EXPECT_FALSE(bench.near(image, 0.9, 0.3, isGreen));
}

TEST(Overlay, PointsTheArrowForward) {
  const Bench bench;
  const std::vector marks{bench.mark(0.6, 0.45, 1.5707963)};

  const optics::RgbImage image = bench.draw(marks);

  const double tip = 1.5 * bench.cap.cap_radius;
  EXPECT_TRUE(bench.near(image, 0.6, 0.45 + tip, isGreen));
  EXPECT_FALSE(bench.near(image, 0.6, 0.45 - tip, isGreen));
}

TEST(Overlay, DrawsADegradedPoseInItsOwnColour) {
  const Bench bench;
  std::vector marks{bench.mark(0.6, 0.45, 0)};
  marks.front().pose.quality = 0.3F;

  const optics::RgbImage image = bench.draw(marks);

  EXPECT_TRUE(bench.near(image, 0.6, 0.45 + bench.cap.cap_radius, isOrange));
}

TEST(Overlay, MarksRejectedCandidatesWithACross) {
  const Bench bench;
  const std::vector<detector::Rejection> rejected{
      {{200, 100}, detector::Reason::kSize, 1.8F, 1.2F}};

  const optics::RgbImage image = bench.draw({}, rejected);

  EXPECT_TRUE(isRed(image.at(200, 100)));
  EXPECT_TRUE(isRed(image.at(203, 103)));
  EXPECT_EQ(image.at(200, 120)[0], 180);
}

TEST(Overlay, DrawsAtTheSamePlacesOnAReducedPicture) {
  const Bench bench;
  const std::vector marks{bench.mark(0.3, 0.6, 0)};

  const optics::RgbImage image = bench.draw(marks, {}, kWidth / 2);

  EXPECT_EQ(image.width, kWidth / 2);
  EXPECT_EQ(image.height, kHeight / 2);
  EXPECT_TRUE(bench.near(image, 0.3 + bench.cap.cap_radius, 0.6, isGreen));
  EXPECT_EQ(image.at(10, 200)[1], 180);
}

TEST(Overlay, BrightensDarkPictures) {
  Bench bench;
  bench.picture = optics::GreyImage(kWidth, kHeight, 12);

  EXPECT_EQ(bench.draw({}).at(320, 240)[0], 12 * 16);
}

TEST(Overlay, SurvivesPosesFarOutside) {
  const Bench bench;
  std::vector marks{bench.mark(40, -70, 0), bench.mark(std::nan(""), 0, 0)};
  marks.front().label = "#1";

  EXPECT_EQ(bench.draw(marks).width, kWidth);
}

TEST(Overlay, LabelsBoundRobotsAndUnboundTracks) {
  Track bound;
  bound.number = 12;
  bound.robot_id = 3;
  bound.detected = true;
  Track unbound;
  unbound.number = 13;

  const std::vector<Mark> marks = marksOf(std::vector{bound, unbound});

  EXPECT_EQ(marks.at(0).label, "R3");
  EXPECT_TRUE(marks.at(0).detected);
  EXPECT_EQ(marks.at(1).label, "#13");
  EXPECT_FALSE(marks.at(1).detected);
}

TEST(RejectionText, GivesFoundAndAllowedValuesInCentimetres) {
  const std::string spacing = rejectionText({{}, detector::Reason::kSpacing, 0.0391F, 0.0375F});
  const std::string size = rejectionText({{}, detector::Reason::kSize, 1.83F, 1.25F});
  const std::string fit = rejectionText(
      {{}, detector::Reason::kCircleFit, static_cast<float>(detector::FitFault::kNotDark), 0});

  EXPECT_NE(spacing.find("3.91/3.75 cm"), std::string::npos) << spacing;
  EXPECT_NE(size.find("1.83/1.25"), std::string::npos) << size;
  EXPECT_EQ(fit, "not dark");
}

TEST(Canvas, DrawsDifferentGlyphsForDifferentLetters) {
  optics::RgbImage zero(8, 9);
  optics::RgbImage eight(8, 9);
  optics::RgbImage unknown(8, 9);

  optics::Canvas(zero).text(1, 1, "0", {255, 255, 255});
  optics::Canvas(eight).text(1, 1, "8", {255, 255, 255});
  optics::Canvas(unknown).text(1, 1, "~", {255, 255, 255});

  EXPECT_NE(zero.pixels, eight.pixels);
  EXPECT_EQ(unknown.at(1, 1)[0], 255);
  EXPECT_EQ(unknown.at(3, 3)[0], 0);
}

TEST(RgbImage, SurvivesPngEncodingBitByBit) {
  optics::RgbImage image(5, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>(i * 4);
  }
  const std::vector<std::uint8_t> png = optics::pngBytes(image);

  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> read(
      stbi_load_from_memory(png.data(), static_cast<int>(png.size()), &width, &height, &channels,
                            3),
      stbi_image_free);

  ASSERT_TRUE(read);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 4);
  EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), read.get()));
}

TEST(RgbImage, RefusesToEncodeAnEmptyImage) {
  EXPECT_THROW((void)optics::pngBytes({}), std::runtime_error);
  EXPECT_THROW((void)optics::jpegBytes({}), std::runtime_error);
}

TEST(ContactSheet, PutsTilesInRows) {
  std::vector<optics::RgbImage> tiles;
  for (int i = 0; i < 4; ++i) {
    tiles.emplace_back(10, 8);
    std::fill(tiles.back().pixels.begin(), tiles.back().pixels.end(),
              static_cast<std::uint8_t>(100 + i));
  }

  const optics::RgbImage sheet = optics::contactSheet(tiles, 3);

  EXPECT_GE(sheet.width, 30);
  EXPECT_GE(sheet.height, 16);
  EXPECT_EQ(sheet.at(0, 0)[0], 100);
  EXPECT_EQ(sheet.at(sheet.width - 1, 0)[0], 102);
  EXPECT_EQ(sheet.at(0, sheet.height - 1)[0], 103);
}

}  // namespace
}  // namespace lab::tracker
