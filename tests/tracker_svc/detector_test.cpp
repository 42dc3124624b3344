/// Detection in whole pictures of the simulated camera, compared with the true poses.
#include "tracker_svc/detector.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/tracker_svc/detector/scattered_robots.hpp"

namespace lab::detector {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

struct Scene {
  sim::PainterSettings settings;
  std::vector<sim::PaintedRobot> robots;
  light::Field field;

  explicit Scene(int count, std::uint64_t seed = 1) {
    settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
    settings.seed = seed;
    field.layers = {{.kind = light::LayerKind::kUniform, .intensity = 1}};
    robots = scatteredRobots(count, seed);
  }

  [[nodiscard]] optics::GreyImage paint(std::int64_t number = 0) const {
    sim::CameraPainter painter(settings);
    painter.setLight(field);
    optics::GreyImage image(settings.camera.width, settings.camera.height);
    painter.paint(robots, number, image.pixels);
    return image;
  }
  [[nodiscard]] Detector detector() const {
    return {optics::CameraModel(settings.camera), settings.cap, settings.imaging};
  }
};

struct Score {
  int found = 0;
  int wrong = 0;        ///< detections that belong to no robot
  double position = 0;  ///< [m] root mean square, 2-D
  double heading = 0;   ///< [rad] root mean square
};

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

Score score(const std::vector<Detection>& seen, const std::vector<sim::PaintedRobot>& robots) {
  constexpr double kSame = 0.01;  // [m]
  Score score;
  std::vector<bool> used(seen.size(), false);
  for (const sim::PaintedRobot& robot : robots) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double distance = std::hypot(seen[i].x - robot.x, seen[i].y - robot.y);
      if (used[i] || distance > kSame) continue;
      used[i] = true;
      ++score.found;
      score.position += distance * distance;
      score.heading += std::pow(wrapped(seen[i].theta - robot.theta), 2);
      break;
    }
  }
  for (const bool one : used) score.wrong += one ? 0 : 1;
  const double count = std::max(score.found, 1);
  score.position = std::sqrt(score.position / count);
  score.heading = std::sqrt(score.heading / count);
  return score;
}

bool sameBits(const Detection& a, const Detection& b) {
  const auto same = [](double p, double q) {
    return std::bit_cast<std::uint64_t>(p) == std::bit_cast<std::uint64_t>(q);
  };
  bool all = same(a.x, b.x) && same(a.y, b.y) && same(a.theta, b.theta) && a.used == b.used &&
             a.quality == b.quality && a.spacing == b.spacing && a.white == b.white;
  for (std::size_t i = 0; i < a.covariance.size(); ++i) {
    all = all && same(a.covariance[i], b.covariance[i]);
  }
  return all;
}

TEST(Detector, FindsEveryCapToAFewMicrometres) {
  const Scene scene(40);
  Detector detector = scene.detector();
  const Score result = score(detector.search(scene.paint().view()), scene.robots);
  EXPECT_EQ(result.found, 40);
  EXPECT_EQ(result.wrong, 0);
  EXPECT_LT(result.position, 20e-6);
  EXPECT_LT(result.heading, 0.04 * std::numbers::pi / 180);
}

TEST(Detector, FindsCapsThatLightEdgesCross) {
  for (const light::Layer& layer : {light::Layer{.kind = light::LayerKind::kStripes,
                                   .x = 0.013,
                                   .angle = 0.35,
                                   .size = 0.08,
                                   .inner = 0.5,
                                   .softness = 0.001,
                                   .intensity = 1,
                                   .intensity2 = 0.35},
                                    light::Layer{.kind = light::LayerKind::kHalfPlane,
                                    .x = 0.6,
                                    .y = 0.45,
                                    .angle = 0.44,
                                    .softness = 0.001,
                                    .intensity = 1},
                                    light::Layer{.kind = light::LayerKind::kLinearGradient,
                                    .x = 0.6,
                                    .y = 0.45,
                                    .size = 1.2,
                                    .intensity = 0.12,
                                    .intensity2 = 1}}) {
    Scene scene(20, 3);
    scene.field.layers = {{.kind = light::LayerKind::kUniform, .intensity = 0.12}, layer};
    Detector detector = scene.detector();
    const Score result = score(detector.search(scene.paint().view()), scene.robots);
    EXPECT_EQ(result.found, 20) << static_cast<int>(layer.kind);
    EXPECT_EQ(result.wrong, 0) << static_cast<int>(layer.kind);
    EXPECT_LT(result.position, 60e-6) << static_cast<int>(layer.kind);
  }
}

TEST(Detector, FindsCapsInResidualRoomLight) {
  Scene scene(20, 4);
  scene.field.layers = {{.kind = light::LayerKind::kUniform, .intensity = 0}};
  Detector detector = scene.detector();
  const Score result = score(detector.search(scene.paint().view()), scene.robots);
  EXPECT_GE(result.found, 19);
  EXPECT_EQ(result.wrong, 0);
}

TEST(Detector, RejectsDiscsOnTheBareFloorWithAReason) {
  Scene scene(0);
  // On the floor a pair looks 3 % smaller: tested with its real size, and enlarged by that factor.
  for (const double scale : {1.0, 1.03}) {
    const double x = scale > 1 ? 0.8 : 0.4;
    const optics::CapGeometry& cap = scene.settings.cap;
    scene.settings.discs.push_back({x + scale * cap.big_offset, 0.4, scale * cap.big_radius, 0.07});
    scene.settings.discs.push_back(
        {x + scale * cap.small_offset, 0.4, scale * cap.small_radius, 0.07});
  }
  scene.settings.discs.push_back({0.2, 0.7, 0.009, 0.07});
  Detector detector = scene.detector();
  std::vector<Rejection> rejected;
  EXPECT_TRUE(detector.search(scene.paint().view(), &rejected).empty());
  int no_cap = 0;
  int no_partner = 0;
  for (const Rejection& one : rejected) {
    no_cap += one.reason == Reason::kNoCap ? 1 : 0;
    no_partner += one.reason == Reason::kNoPartner ? 1 : 0;
    EXPECT_NE(toText(one.reason), "?");
  }
  EXPECT_GE(no_cap, 2);
  EXPECT_GE(no_partner, 1);
}

TEST(Detector, SeparatesNeighboursInContact) {
  Scene scene(0);
  // A chain in which facing circles of neighbours are 3.9 cm apart, hardly more than those of one
  // robot.
  for (int i = 0; i < 10; ++i) {
    scene.robots.push_back({0.2 + 0.0751 * i, 0.45, i % 2 == 0 ? 0.0 : std::numbers::pi, 0, 0, 0});
  }
  Detector detector = scene.detector();
  const Score result = score(detector.search(scene.paint().view()), scene.robots);
  EXPECT_EQ(result.found, 10);
  EXPECT_EQ(result.wrong, 0);
  EXPECT_LT(result.heading, 0.01);
}

TEST(Detector, FollowGivesTheSameBitsAsSearch) {
  Scene scene(30, 5);
  scene.field.layers.push_back({.kind = light::LayerKind::kHalfPlane,
                                .x = 0.6,
                                .y = 0.45,
                                .angle = 1,
                                .softness = 0.001,
                                .intensity = 0.3});
  const optics::GreyImage image = scene.paint();
  const optics::GreyView picture{image.pixels.data(), kWidth, kHeight, kWidth};
  Detector detector = scene.detector();
  const std::vector<Detection> all = detector.search(picture);
  ASSERT_EQ(all.size(), 30U);
  std::vector<Expected> expected;
  for (const Detection& one : all) {
    expected.push_back({one.x + 0.004, one.y - 0.003, one.theta + 0.2, 0.01, 0.5});
  }
  expected.push_back(expected.front());      // requested twice, returned once
  expected.push_back({0.6, 0.45, 0, 0, 0});  // no robot is exactly there
  expected.push_back({5, 5, 0, 0.01, 0.5});  // outside the picture
  const std::vector<Detection>& followed = detector.follow(picture, expected);
  ASSERT_EQ(followed.size(), expected.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(sameBits(all[i], followed[i])) << i;
  for (std::size_t i = all.size(); i < followed.size(); ++i) EXPECT_EQ(followed[i].quality, 0);
}

TEST(Detector, FollowGivesTheSameBitsFromAnyPlaceNearby) {
  const Scene scene(40, 8);
  const optics::GreyImage image = scene.paint();
  const optics::GreyView picture{image.pixels.data(), kWidth, kHeight, kWidth};
  Detector detector = scene.detector();
  const std::vector<Detection> all = detector.search(picture);
  ASSERT_EQ(all.size(), 40U);
  for (const double angle : {0.5, 2.5, 4.5}) {
    for (const double away : {0.0, 0.001, 0.003, 0.006, 0.012}) {
      std::vector<Expected> expected;
      for (const Detection& one : all) {
        expected.push_back({one.x + away * std::cos(angle), one.y + away * std::sin(angle),
                            one.theta + 20 * away, 0.02, 0.5});
      }
      const std::vector<Detection>& followed = detector.follow(picture, expected);
      int same = 0;
      for (std::size_t i = 0; i < all.size(); ++i) same += sameBits(all[i], followed[i]) ? 1 : 0;
      EXPECT_EQ(same, 40) << angle << " " << away;
    }
  }
}

TEST(Detector, FollowGivesTheSameBitsWithGammaEncodedPictures) {
  Scene scene(20, 9);
  scene.settings.imaging.gamma = 2.2;
  const optics::GreyImage image = scene.paint();
  Detector detector = scene.detector();
  const std::vector<Detection> all = detector.search(image.view());
  ASSERT_EQ(all.size(), 20U);
  std::vector<Expected> expected;
  for (const Detection& one : all) expected.push_back({one.x, one.y, one.theta, 0.01, 0.5});
  const std::vector<Detection>& followed = detector.follow(image.view(), expected);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(sameBits(all[i], followed[i])) << i;
  // The ratio of the paint itself, not that of the encoded grey values.
  for (const Detection& one : all) EXPECT_NEAR(one.ratio, 0.08, 0.01);
  detector.setGamma(1);
  EXPECT_LT(detector.search(image.view()).size(), 10U);
}

TEST(Detector, FollowIgnoresACapThatIsTurnedTooFar) {
  const Scene scene(1, 6);
  Detector detector = scene.detector();
  const optics::GreyImage image = scene.paint();
  const optics::GreyView picture{image.pixels.data(), kWidth, kHeight, kWidth};
  const sim::PaintedRobot& robot = scene.robots.front();
  const Expected turned{robot.x, robot.y, robot.theta + 1, 0.01, 0.5};
  EXPECT_EQ(detector.follow(picture, {&turned, 1}).front().quality, 0);
  const Expected right{robot.x, robot.y, robot.theta + 0.4, 0.01, 0.5};
  EXPECT_GT(detector.follow(picture, {&right, 1}).front().quality, 0.5);
}

TEST(Detector, FindsNothingInEmptyPictures) {
  const Scene scene(0);
  Detector detector = scene.detector();
  std::mt19937_64 random(7);
  optics::GreyImage image(kWidth, kHeight);
  for (const int value : {0, 2, 128, 255}) {
    image.pixels.assign(image.pixels.size(), static_cast<std::uint8_t>(value));
    EXPECT_TRUE(detector.search(image.view()).empty()) << value;
  }
  for (int round = 0; round < 3; ++round) {
    for (std::uint8_t& pixel : image.pixels) pixel = static_cast<std::uint8_t>(random());
    EXPECT_TRUE(detector.search(image.view()).empty()) << round;
    const Expected everywhere{0.6, 0.45, 0, 1, 4};
    EXPECT_EQ(detector.follow(image.view(), {&everywhere, 1}).front().quality, 0);
  }
}

TEST(Detector, RejectsPicturesOfAnotherSize) {
  const Scene scene(0);
  Detector detector = scene.detector();
  optics::GreyImage image(kWidth, kHeight, 100);
  EXPECT_TRUE(detector.search({nullptr, kWidth, kHeight, kWidth}).empty());
  EXPECT_TRUE(detector.search({image.pixels.data(), kWidth, kHeight, kWidth - 1}).empty());
  EXPECT_TRUE(detector.search({image.pixels.data(), kWidth / 2, kHeight, kWidth}).empty());
  EXPECT_TRUE(detector.search({image.pixels.data(), 0, 0, 0}).empty());
  const Expected one{0.6, 0.45, 0, 0.01, 0.5};
  EXPECT_EQ(detector.follow({nullptr, 0, 0, 0}, {&one, 1}).front().quality, 0);
}

TEST(Detector, WorksWithCamerasThatSeeNoCaps) {
  for (const int size : {1, 8, 40}) {
    optics::CameraParameters camera = optics::simulatedCamera(size, size, 1.20, 0.90);
    Detector detector(optics::CameraModel(camera), {});
    optics::GreyImage image(size, size, 50);
    EXPECT_TRUE(detector.search(image.view()).empty()) << size;
  }
  optics::CameraParameters up = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
  up.translation[2] = -1;  // the arena is behind the camera
  Detector detector(optics::CameraModel(up), {});
  EXPECT_TRUE(detector.search(optics::GreyImage(kWidth, kHeight, 50).view()).empty());
}

}  // namespace
}  // namespace lab::detector
