/// Poses of caps with one covered circle, from the other circle and the rim.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "light/optics/simulated_camera.hpp"
#include "tests/tracker_svc/covered_cap.hpp"
#include "tracker_svc/detector.hpp"
#include "tracker_svc/detector/cap_pose.hpp"
#include "tracker_svc/detector/rim_fit.hpp"

namespace lab::detector::degraded_pose_test {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr double kReach = 0.0096;  // [m] after 20 ms
constexpr double kTurn = 0.26;     // [rad]

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

bool isDegraded(const Detection& one) { return (one.used & kUsedRim) != 0; }

struct Scene {
  sim::PainterSettings settings;
  std::vector<sim::PaintedRobot> robots;
  light::Field field;
  std::mt19937_64 random{3};

  Scene() {
    settings.camera = optics::simulatedCamera(kWidth, kHeight, 1.20, 0.90);
    field.layers = {{.kind = light::LayerKind::kUniform, .intensity = 1}};
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  /// A grid of robots, all with different headings and sub-pixel positions.
  void fill() {
    for (int i = 0; i < 8; ++i) {
      for (int j = 0; j < 6; ++j) {
        robots.push_back({0.08 + 0.148 * i + between(-0.03, 0.03),
                          0.08 + 0.148 * j + between(-0.03, 0.03), between(-3.1, 3.1)});
      }
    }
  }
  [[nodiscard]] optics::GreyImage paint() const {
    sim::CameraPainter painter(settings);
    painter.setLight(field);
    optics::GreyImage image(kWidth, kHeight);
    painter.paint(robots, 0, image.pixels);
    return image;
  }
  [[nodiscard]] optics::CameraModel camera() const { return optics::CameraModel(settings.camera); }
  [[nodiscard]] Detector detector() const { return {camera(), settings.cap, settings.imaging}; }
  /// The expectation of a tracker that followed them.
  std::vector<Expected> expected() {
    std::vector<Expected> out;
    for (const sim::PaintedRobot& robot : robots) {
      out.push_back({robot.x + between(-0.004, 0.004), robot.y + between(-0.004, 0.004),
                     robot.theta + between(-0.2, 0.2), kReach, kTurn});
    }
    return out;
  }
};

/// Normalised squared error e' C^-1 e.
double nees(const std::array<double, 6>& c, const std::array<double, 3>& e) {
  double m[3][4] = {{c[0], c[1], c[2], e[0]}, {c[1], c[3], c[4], e[1]}, {c[2], c[4], c[5], e[2]}};
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 3; ++j) {
      const double share = m[j][i] / m[i][i];
      for (int k = i; k < 4; ++k) m[j][k] -= share * m[i][k];
    }
  }
  double x[3];
  double out = 0;
  for (int i = 2; i >= 0; --i) {
    x[i] = m[i][3];
    for (int k = i + 1; k < 3; ++k) x[i] -= m[i][k] * x[k];
    x[i] /= m[i][i];
    out += x[i] * e[static_cast<std::size_t>(i)];
  }
  return out;
}

TEST(DegradedPose, HasTheErrorsOfItsCovariance) {
  for (const double light : {1.0, 0.12}) {
    Scene scene;
    scene.field.layers[0].intensity = light;
    scene.fill();
    optics::GreyImage picture = scene.paint();
    for (std::size_t i = 0; i < scene.robots.size(); ++i) {
      Cover cover = overCircle(scene.robots[i], i % 2 == 0);
      cover.grey *= light;
      lay(cover, scene.camera(), picture);
    }
    Detector dut = scene.detector();
    EXPECT_TRUE(dut.search(picture.view()).empty()) << "none that is not expected";
    const std::vector<Expected> expected = scene.expected();
    const std::vector<Detection> seen = dut.follow(picture.view(), expected);
    double sum = 0;
    double most = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const sim::PaintedRobot& robot = scene.robots[i];
      ASSERT_EQ(seen[i].used, kUsedRim | (i % 2 == 0 ? kUsedSmall : kUsedBig)) << i;
      EXPECT_GT(seen[i].quality, 0.2F);
      EXPECT_LT(seen[i].quality, 0.5F);
      EXPECT_EQ(seen[i].spacing, 0);
      const double z = nees(seen[i].covariance, {seen[i].x - robot.x, seen[i].y - robot.y,
                                                 wrapped(seen[i].theta - robot.theta)});
      sum += z;
      most = std::max(most, z);
      EXPECT_LT(std::hypot(seen[i].x - robot.x, seen[i].y - robot.y), 0.0006) << i;
      EXPECT_LT(std::abs(wrapped(seen[i].theta - robot.theta)), 0.03) << i;
    }
    const double mean = sum / static_cast<double>(3 * seen.size());
    // 144 degrees of freedom: upper limit 1 + 3 sqrt(2 / 144). The lower limit is wider: the rim's
    // error floor is for rims that differ around the cap, of which the painter has only the body's
    // side.
    EXPECT_LT(mean, 1.35) << light;
    EXPECT_GT(mean, 0.3) << light;
    EXPECT_LT(most, 21) << "one of 10000 of three degrees of freedom";
  }
}

TEST(DegradedPose, IsTheSameFromFollowAndSearch) {
  Scene scene;
  scene.fill();
  optics::GreyImage picture = scene.paint();
  for (std::size_t i = 0; i < scene.robots.size(); i += 4) {
    lay(overCircle(scene.robots[i], i % 8 == 0), scene.camera(), picture);
  }
  Detector dut = scene.detector();
  const std::vector<Expected> expected = scene.expected();
  const std::vector<Detection> followed = dut.follow(picture.view(), expected);
  const std::vector<Detection> searched = dut.search(picture.view(), nullptr, expected);
  ASSERT_EQ(searched.size(), scene.robots.size());
  const std::size_t degraded = scene.robots.size() / 4;
  for (std::size_t i = 0; i < searched.size(); ++i) {
    EXPECT_EQ(isDegraded(searched[i]), i >= searched.size() - degraded) << "the last ones";
  }
  for (std::size_t k = 0; k < degraded; ++k) {
    const Detection& one = followed[4 * k];
    const Detection& other = searched[searched.size() - degraded + k];
    EXPECT_EQ(one.x, other.x);
    EXPECT_EQ(one.theta, other.theta);
    EXPECT_EQ(one.covariance, other.covariance);
  }
}

TEST(DegradedPose, IsFoundForACapHalfOutsideThePicture) {
  Scene scene;
  // The lower edge of the picture cuts off the small circle.
  const optics::CameraModel camera = scene.camera();
  const std::optional<optics::Place> edge =
      camera.toPlane({kWidth / 2.0, kHeight - 1.0}, scene.settings.cap.height);
  ASSERT_TRUE(edge);
  scene.robots = {{edge->x, edge->y + 0.012, std::numbers::pi / 2 + 0.2}};
  const optics::GreyImage picture = scene.paint();
  const optics::GreyView view{picture.pixels.data(), kWidth, kHeight, kWidth};
  Detector dut = scene.detector();
  EXPECT_TRUE(dut.search(view).empty());
  const std::vector<Expected> expected = scene.expected();
  const Detection seen = dut.follow(view, expected).front();
  ASSERT_EQ(seen.used & ~kUsedEdge, kUsedRim | kUsedBig);
  const sim::PaintedRobot& robot = scene.robots.front();
  EXPECT_LT(nees(seen.covariance,
                 {seen.x - robot.x, seen.y - robot.y, wrapped(seen.theta - robot.theta)}),
            16);
  EXPECT_LT(std::hypot(seen.x - robot.x, seen.y - robot.y), 0.0004);
}

TEST(DegradedPose, IsNotReportedForADiscOnTheBareFloor) {
  Scene scene;
  const optics::CapGeometry& cap = scene.settings.cap;
  std::vector<Expected> expected;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.1 + 0.11 * (i % 10);
    const double y = 0.15 + 0.2 * (i / 10);
    const bool big = i % 2 == 0;
    const double scale = i % 3 == 0 ? 1.0 : 1.03;  // real size, and enlarged so that it looks right
    scene.settings.discs.push_back({x, y, scale * (big ? cap.big_radius : cap.small_radius), 0.07});
    // Expected where a cap around the disc would be, at any heading; the disc is imaged beside its
    // place.
    const std::optional<optics::Place> seen =
        scene.camera().toPlane(scene.camera().project(x, y, 0), cap.height);
    ASSERT_TRUE(seen);
    const double theta = scene.between(-3.1, 3.1);
    const double offset = big ? cap.big_offset : cap.small_offset;
    expected.push_back({seen->x - offset * std::cos(theta), seen->y - offset * std::sin(theta),
                        theta, cap.cap_radius, std::numbers::pi});
  }
  const optics::GreyImage picture = scene.paint();
  const optics::GreyView view{picture.pixels.data(), kWidth, kHeight, kWidth};
  Detector dut = scene.detector();
  for (const Detection& one : dut.follow(view, expected)) EXPECT_EQ(one.quality, 0);
  EXPECT_TRUE(dut.search(view, nullptr, expected).empty());
}

struct Lost : testing::Test {
  Scene scene;
  Lost() { scene.robots = {{0.5, 0.4, 0.7}}; }

  Detection follow(const std::vector<Cover>& covers, const Expected& expected) {
    optics::GreyImage picture = scene.paint();
    for (const Cover& cover : covers) lay(cover, scene.camera(), picture);
    Detector dut = scene.detector();
    return dut.follow(picture.view(), {&expected, 1}).front();
  }
};

TEST_F(Lost, IsFoundDegradedWithOneCircleCovered) {
  EXPECT_TRUE(
      isDegraded(follow({overCircle(scene.robots[0], true)}, {0.503, 0.398, 0.8, kReach, kTurn})));
}

TEST_F(Lost, WithBothCirclesCovered) {
  const sim::PaintedRobot& robot = scene.robots[0];
  EXPECT_EQ(follow({overCircle(robot, true), overCircle(robot, false)},
                   {0.503, 0.398, 0.8, kReach, kTurn})
                .quality,
            0);
}

TEST_F(Lost, WithHalfOfTheCapCovered) {
  // A sheet as bright as the cap, or as dark as a body, over one circle and half of the rim.
  const sim::PaintedRobot& robot = scene.robots[0];
  for (const double grey : {40.0, 170.0}) {
    const Cover sheet{onCap(robot, 0.045, -0.08), onCap(robot, 0.045, 0.08), 0.04, grey};
    const Detection seen = follow({sheet}, {0.503, 0.398, 0.8, kReach, kTurn});
    EXPECT_EQ(seen.quality, 0) << grey;
  }
}

TEST_F(Lost, WithReversedHeading) {
  // The visible circle is where the other one is expected; its size shows that.
  const sim::PaintedRobot& robot = scene.robots[0];
  for (const bool big : {false, true}) {
    EXPECT_EQ(follow({overCircle(robot, big)},
                     {robot.x, robot.y, robot.theta + std::numbers::pi, kReach, kTurn})
                  .quality,
              0);
  }
}

TEST_F(Lost, ThatHasMovedTooFar) {
  const sim::PaintedRobot& robot = scene.robots[0];
  const Cover cover = overCircle(robot, false);
  EXPECT_EQ(follow({cover}, {robot.x + 0.012, robot.y, robot.theta, kReach, kTurn}).quality, 0);
  // Lost for so long that another cap could be meant.
  EXPECT_EQ(follow({cover}, {robot.x, robot.y, robot.theta, 0.15, 3}).quality, 0);
  EXPECT_TRUE(isDegraded(follow({cover}, {robot.x, robot.y, robot.theta, 0.035, 3})));
}

TEST_F(Lost, BesideADetectedCap) {
  // A second track that expects a cap beside a detected one must not get a pose from it.
  const sim::PaintedRobot& robot = scene.robots[0];
  EXPECT_EQ(follow({}, {robot.x + 0.03, robot.y, robot.theta, 0.02, kTurn}).quality, 0);
}

TEST(RimFit, FindsTheMiddleFromAMillimetreOff) {
  Scene scene;
  scene.robots = {{0.3, 0.6, 1}, {0.9, 0.2, -2}};
  const optics::GreyImage picture = scene.paint();
  const optics::GreyView view{picture.pixels.data(), kWidth, kHeight, kWidth};
  for (const sim::PaintedRobot& robot : scene.robots) {
    const RimFit fit = fitRim(view, scene.camera(), scene.settings.cap, scene.settings.imaging,
                              {robot.x + 0.0008, robot.y - 0.0006});
    EXPECT_EQ(fit.visible, kRimDirections);
    EXPECT_GT(fit.support, kRimDirections * 3 / 4);
    EXPECT_NEAR(fit.centre.x, robot.x, 4 * std::sqrt(fit.covariance[0]));
    EXPECT_NEAR(fit.centre.y, robot.y, 4 * std::sqrt(fit.covariance[2]));
    EXPECT_LT(fit.covariance[0] + fit.covariance[2], 2 * 0.0003 * 0.0003);
  }
  const RimFit floor =
      fitRim(view, scene.camera(), scene.settings.cap, scene.settings.imaging, {0.6, 0.45});
  EXPECT_LT(floor.support, kRimDirections / 4);
}

// Linear for small errors, so that the mean of e' C^-1 e is the number of degrees of freedom.
TEST(CapPose, FromOneCircleAndTheMiddleHasTheRightCovariance) {
  const optics::CapGeometry cap;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kCount = 4000;
  double sum = 0;
  double distance = 0;
  for (int i = 0; i < kCount; ++i) {
    const double theta = 6.28 * i / kCount;
    const double offset = i % 2 == 0 ? cap.big_offset : cap.small_offset;
    const std::array<double, 3> circle{1e-10, 0.4e-10, 2e-10};
    const std::array<double, 3> middle{2e-8, -0.8e-8, 1e-8};
    const auto noisy = [&](double x, double y, const std::array<double, 3>& c) {
      const double a = std::sqrt(c[0]);
      const double b = c[1] / a;
      const double u = normal(random);
      return optics::Place{x + a * u, y + b * u + std::sqrt(c[2] - b * b) * normal(random)};
    };
    const CapPose pose = poseFromRim(
        {noisy(0.4 + offset * std::cos(theta), 0.3 + offset * std::sin(theta), circle), circle},
        offset, {noisy(0.4, 0.3, middle), middle});
    sum += nees(pose.covariance, {pose.x - 0.4, pose.y - 0.3, wrapped(pose.theta - theta)});
    distance += pose.spacing_chi2;
  }
  EXPECT_NEAR(sum / kCount, 3, 4 * std::sqrt(6.0 / kCount));
  EXPECT_NEAR(distance / kCount, 1, 4 * std::sqrt(2.0 / kCount));
}

// A finger on one side of a circle leaves almost a smaller circle beside it.
TEST(DegradedPose, ACircleWithAWhiteCoverOnOneSideIsNotUsed) {
  Scene scene;
  scene.fill();
  optics::GreyImage picture = scene.paint();
  const optics::CameraModel camera = scene.camera();
  const optics::CapGeometry& cap = scene.settings.cap;
  constexpr double kWide = 0.006;  // [m] half of the strip
  for (const sim::PaintedRobot& robot : scene.robots) {
    const optics::Place middle = onCap(robot, 0);
    const optics::Pixel white = camera.project(middle.x, middle.y, cap.height);
    const double beside = 0.58 * cap.big_radius + kWide;
    lay({onCap(robot, cap.big_offset - 0.01, beside), onCap(robot, cap.big_offset + 0.01, beside),
         kWide,
         static_cast<double>(picture.row(static_cast<int>(white.y))[static_cast<int>(white.x)])},
        camera, picture);
  }
  Detector detector = scene.detector();

  int wrong = 0;
  for (const Detection& one : detector.search(picture.view(), nullptr, scene.expected())) {
    if (!isDegraded(one)) ++wrong;
  }

  EXPECT_LE(wrong, static_cast<int>(scene.robots.size()) / 20) << "of " << scene.robots.size();
}

}  // namespace
}  // namespace lab::detector::degraded_pose_test
