/// Tests of the detector's parts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/circle_search/occupancy_map.hpp"
#include "tracker_svc/detector/cap_check.hpp"
#include "tracker_svc/detector/pairing.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector::detector_parts_test {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

optics::CameraModel camera() {
  return optics::CameraModel(optics::simulatedCamera(kWidth, kHeight, 0.5, 0.4));
}

/// Paints a hard-edged disc in the plane of the caps: 8 x 8 samples per pixel.
void paintDisc(optics::GreyImage& image, double x, double y, double radius, double value) {
  const optics::CapGeometry cap;
  const optics::CameraModel model = camera();
  const optics::Pixel at = model.project(x, y, cap.height);
  const double reach = 2 * radius * model.scaleAt({x, y}, cap.height).ux;
  for (int v = static_cast<int>(at.y - reach); v <= static_cast<int>(at.y + reach); ++v) {
    for (int u = static_cast<int>(at.x - reach); u <= static_cast<int>(at.x + reach); ++u) {
      int inside = 0;
      for (int i = 0; i < 64; ++i) {
        const auto place =
            model.toPlane({u + (i % 8 - 3.5) / 8, v + (i / 8 - 3.5) / 8}, cap.height);
        inside += place && std::hypot(place->x - x, place->y - y) < radius ? 1 : 0;
      }
      std::uint8_t& pixel = image.row(v)[u];
      pixel = static_cast<std::uint8_t>(std::lround(pixel + (value - pixel) * inside / 64.0));
    }
  }
}

TEST(OccupancyMap, CoversADiscExactly) {
  OccupancyMap map(320, 240);
  map.cover(100.3F, 90.7F, 37);
  int covered = 0;
  int within = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const bool is_within = std::hypot(x - 100.3, y - 90.7) < 37;
      within += is_within ? 1 : 0;
      if (!map.isCovered(x, y)) continue;
      ++covered;
      EXPECT_TRUE(is_within) << x << ", " << y;
    }
  }
  EXPECT_EQ(covered, within);
  EXPECT_TRUE(map.isCovered(70, 130, 91));
  EXPECT_FALSE(map.isCovered(70, 150, 91));
  map.cover(150, 90, 37);  // an overlapping disc does not change the first
  EXPECT_TRUE(map.isCovered(70, 130, 91));
  EXPECT_TRUE(map.isCovered(120, 180, 91));
  EXPECT_FALSE(map.isCovered(70, 180, 91)) << "by two of them, and not by one";
  map.forget();
  EXPECT_FALSE(map.isCovered(100, 90));
}

TEST(ScaleMap, GivesTheOutlineInTheCamerasPicture) {
  const optics::CapGeometry cap;
  const optics::CameraModel model = camera();
  const ScaleMap map(model, cap);
  for (const optics::Place place : {optics::Place{0.05, 0.05}, {0.25, 0.2}, {0.45, 0.33}}) {
    const optics::Pixel centre = model.project(place.x, place.y, cap.height);
    const LocalScale scale = map.at(centre.x, centre.y);
    const DiscShape shape = discShape(scale, cap.big_radius);
    double sum_x = 0;
    double sum_y = 0;
    for (int i = 0; i < 360; ++i) {
      const double angle = i * std::numbers::pi / 180;
      const optics::Pixel rim =
          model.project(place.x + cap.big_radius * std::cos(angle),
                        place.y + cap.big_radius * std::sin(angle), cap.height);
      const double dx = rim.x - centre.x;
      const double dy = rim.y - centre.y;
      const double a = static_cast<double>(shape.m[0]) * dx + static_cast<double>(shape.m[1]) * dy;
      const double b = static_cast<double>(shape.m[2]) * dx + static_cast<double>(shape.m[3]) * dy;
      EXPECT_NEAR(std::hypot(a, b), 1, 0.003);
      // The centre of the best fit moves by twice the mean excess along the normals.
      sum_x += 2 * (std::hypot(a, b) - 1) * std::cos(std::atan2(b, a)) / 360;
      sum_y += 2 * (std::hypot(a, b) - 1) * std::sin(std::atan2(b, a)) / 360;
    }
    const auto square = static_cast<float>(cap.big_radius * cap.big_radius);
    const double bent_x = static_cast<double>(scale.bend[0] * square);
    const double bent_y = static_cast<double>(scale.bend[1] * square);
    // In units of the radius; the map from there to pixels is the inverse of `m`.
    const double wanted_x =
        static_cast<double>(shape.m[0]) * bent_x + static_cast<double>(shape.m[1]) * bent_y;
    const double wanted_y =
        static_cast<double>(shape.m[2]) * bent_x + static_cast<double>(shape.m[3]) * bent_y;
    EXPECT_NEAR(sum_x, wanted_x, 1e-4);
    EXPECT_NEAR(sum_y, wanted_y, 1e-4);
  }
}

TEST(CircleSearch, FindsCirclesOfBothSizesInAnyPartOfThePicture) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  optics::GreyImage image(kWidth, kHeight, 200);
  paintDisc(image, 0.15, 0.2, cap.big_radius, 18);
  paintDisc(image, 0.35, 0.2, cap.small_radius, 18);
  CircleSearch search(map, cap, {}, kWidth, kHeight);
  std::vector<Spot> spots;
  const Region all{0, 0, kWidth - 1, kHeight - 1};
  search.find(image.view(), {&all, 1}, spots, nullptr);
  ASSERT_EQ(spots.size(), 2U);
  const optics::Pixel big = camera().project(0.15, 0.2, cap.height);
  const optics::Pixel small = camera().project(0.35, 0.2, cap.height);
  for (const Spot& spot : spots) {
    const optics::Pixel& at = spot.can_be_big ? big : small;
    EXPECT_NE(spot.can_be_big, spot.can_be_small);
    EXPECT_NEAR(static_cast<double>(spot.x), at.x, 0.4);
    EXPECT_NEAR(static_cast<double>(spot.y), at.y, 0.4);
  }
  // Searching a part of the picture finds the circle in it, at the same place.
  const Spot before = spots[0];
  const Region part{static_cast<int>(before.x) - 30, static_cast<int>(before.y) - 30,
                    static_cast<int>(before.x) + 30, static_cast<int>(before.y) + 30};
  search.find(image.view(), {&part, 1}, spots, nullptr);
  ASSERT_EQ(spots.size(), 1U);
  EXPECT_EQ(spots[0].x, before.x);
  EXPECT_EQ(spots[0].y, before.y);
}

TEST(CircleSearch, IgnoresLightEdgesStripesAndLines) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  CircleSearch search(map, cap, {}, kWidth, kHeight);
  std::vector<Spot> spots;
  const Region all{0, 0, kWidth - 1, kHeight - 1};
  for (int kind = 0; kind < 4; ++kind) {
    optics::GreyImage image(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool dark = kind == 0   ? 2 * x + y < 700
                          : kind == 1 ? (3 * x + y) / 64 % 2 == 0
                          : kind == 2 ? std::abs(x - 2 * y + 200) < 8
                                      : std::hypot(x - 320.0, y - 240.0) < 60;
        image.row(y)[x] = dark ? 20 : 200;
      }
    }
    search.find(image.view(), {&all, 1}, spots, nullptr);
    EXPECT_TRUE(spots.empty()) << kind;
  }
}

TEST(CircleSearch, FindsACircleAroundAPlaceInIt) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  optics::GreyImage image(kWidth, kHeight, 200);
  paintDisc(image, 0.15, 0.2, cap.big_radius, 18);
  paintDisc(image, 0.35, 0.2, cap.small_radius, 18);
  CircleSearch search(map, cap, {}, kWidth, kHeight);
  search.aimAt(image.view());
  for (const bool big : {true, false}) {
    const double radius = big ? cap.big_radius : cap.small_radius;
    const double x = big ? 0.15 : 0.35;
    const optics::Pixel centre = camera().project(x, 0.2, cap.height);
    for (int i = 0; i < 8; ++i) {  // up to nearly two radii beside its centre
      const double away = (0.2 + 0.2 * i) * radius;
      const double angle = 0.9 * i;
      const optics::Pixel place =
          camera().project(x + away * std::cos(angle), 0.2 + away * std::sin(angle), cap.height);
      const std::optional<Spot> spot = search.circleAt(place, big);
      ASSERT_TRUE(spot.has_value()) << big << " " << i;
      EXPECT_NEAR(static_cast<double>(spot->x), centre.x, 0.5);
      EXPECT_NEAR(static_cast<double>(spot->y), centre.y, 0.5);
      EXPECT_FALSE(search.circleAt(place, !big).has_value()) << big << " " << i;
    }
  }
  for (const optics::Pixel nothing : {optics::Pixel{320, 60}, {0, 0}, {-50, 100}, {100, 9000}}) {
    EXPECT_FALSE(search.circleAt(nothing, true).has_value());
  }
}

TEST(CircleSearch, FindsACompleteCircleInTheFirstStepAtAnyAlignment) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  CircleSearch search(map, cap, {}, kWidth, kHeight);
  const Region all{0, 0, kWidth - 1, kHeight - 1};
  for (const double radius : {cap.big_radius, cap.small_radius}) {
    for (int i = 0; i < 24; ++i) {
      const optics::Pixel at{256 + 1.4 * i,
                             200 + 0.7 * i};  // covers all alignments with words and rows
      const optics::Place place = camera().toPlane(at, cap.height).value();
      optics::GreyImage image(kWidth, kHeight, 200);
      paintDisc(image, place.x, place.y, radius, 18);
      std::vector<Spot> spots;
      search.findRound(image.view(), {&all, 1}, spots, nullptr);
      ASSERT_EQ(spots.size(), 1U) << radius << " m at " << at.x << ", " << at.y;
      EXPECT_NEAR(static_cast<double>(spots[0].x), at.x, 0.4);
      EXPECT_NEAR(static_cast<double>(spots[0].y), at.y, 0.4);
    }
  }
}

TEST(CircleSearch, SkipsTheAreasOfKnownCaps) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  // A bright corner covers a part of each circle, so that it is not complete.
  optics::GreyImage image(kWidth, kHeight, 200);
  paintDisc(image, 0.15, 0.2, cap.big_radius, 18);
  paintDisc(image, 0.35, 0.2, cap.big_radius, 18);
  const optics::Pixel one = camera().project(0.15, 0.2, cap.height);
  const optics::Pixel other = camera().project(0.35, 0.2, cap.height);
  for (const optics::Pixel& at : {one, other}) {
    for (int v = static_cast<int>(at.y) + 2; v < static_cast<int>(at.y) + 50; ++v) {
      for (int u = static_cast<int>(at.x) + 2; u < static_cast<int>(at.x) + 50; ++u) {
        image.row(v)[u] = static_cast<std::uint8_t>(image.row(v)[u] / 8);
      }
    }
  }
  CircleSearch search(map, cap, {}, kWidth, kHeight);
  std::vector<Spot> spots;
  const Region all{0, 0, kWidth - 1, kHeight - 1};
  search.find(image.view(), {&all, 1}, spots, nullptr);
  EXPECT_EQ(spots.size(), 2U);
  search.findRound(image.view(), {&all, 1}, spots, nullptr);
  EXPECT_TRUE(spots.empty());
  search.cover(one.x, one.y, 3 * cap.big_radius * static_cast<double>(map.at(one.x, one.y).mean));
  search.findRest(Rows::kSome, spots, nullptr);
  ASSERT_EQ(spots.size(), 1U);
  EXPECT_NEAR(static_cast<double>(spots[0].x), other.x, 3);
  search.find(image.view(), {&all, 1}, spots, nullptr);  // covers are reset with the next picture
  EXPECT_EQ(spots.size(), 2U);
}

TEST(CapCheck, DistinguishesACapFromTheFloor) {
  const optics::CapGeometry cap;
  const ScaleMap map(camera(), cap);
  optics::GreyImage image(kWidth, kHeight, 182);
  paintDisc(image, 0.15, 0.2, cap.robot_radius, 50);
  paintDisc(image, 0.15, 0.2, cap.cap_radius, 200);
  const optics::Pixel on_cap = camera().project(0.15, 0.2, cap.height);
  const optics::Pixel on_floor = camera().project(0.35, 0.2, cap.height);
  EXPECT_GT(rimContrast(image.view(), on_cap, map.at(on_cap.x, on_cap.y), cap, {}), 0.15F);
  EXPECT_NEAR(rimContrast(image.view(), on_floor, map.at(on_floor.x, on_floor.y), cap, {}), 0,
              0.02);
  // Mostly outside the picture: no result.
  EXPECT_EQ(rimContrast(image.view(), {-30, -30}, map.at(0, 0), cap, {}), 0);
}

TEST(Pairing, ChoosesTheCheapestPairsAndEachCircleOnce) {
  std::vector<CirclePair> couples = {
      {0, 1, 0.5F, 0}, {0, 2, 0.1F, 0}, {3, 1, 0.7F, 0}, {3, 2, 0.2F, 0}};
  const std::size_t count = choosePairs(couples, 4);
  ASSERT_EQ(count, 2U);
  EXPECT_EQ(couples[0].big, 0);
  EXPECT_EQ(couples[0].small, 2);
  EXPECT_EQ(couples[1].big, 3);
  EXPECT_EQ(couples[1].small, 1);
  std::vector<CirclePair> none;
  EXPECT_EQ(choosePairs(none, 0), 0U);
}

}  // namespace
}  // namespace lab::detector::detector_parts_test
