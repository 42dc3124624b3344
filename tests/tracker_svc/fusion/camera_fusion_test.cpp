#include "tracker_svc/fusion/camera_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lab::tracker::camera_fusion_test {
namespace {

constexpr double kPeriod = 0.04;  // [s]
constexpr double kNoise = 2e-5;   // [m]

/// Six robots on circles of radius 0.15 m in the overlap, and one each that only one camera sees.
struct Scene {
  [[nodiscard]] static detector::Detection robot(int i, double time) {
    const double angle = 0.3 * time + i;
    detector::Detection pose;
    pose.x = 0.4 * i + 0.15 * std::cos(angle);
    pose.y = 0.5 + 0.15 * std::sin(angle);
    pose.theta = std::remainder(angle + M_PI / 2, 2 * M_PI);
    pose.covariance = {kNoise * kNoise, 0, 0, kNoise * kNoise, 0, 1e-6};
    pose.quality = 1;
    pose.used = detector::kUsedBig | detector::kUsedSmall;
    return pose;
  }

  /// What a camera stamps at `time`; its clock is late by `offset`.
  std::vector<detector::Detection> seen(std::size_t camera, double time, double offset) {
    std::vector<detector::Detection> list;
    for (int i = 0; i < 8; ++i) {
      if (i == 0 && camera == 1) continue;
      if (i == 7 && camera == 0) continue;
      detector::Detection pose = robot(i, time - offset);
      pose.x += kNoise * normal(random);
      pose.y += kNoise * normal(random);
      list.push_back(pose);
    }
    return list;
  }

  std::mt19937_64 random{7};
  std::normal_distribution<double> normal;
};

/// [m] largest distance of a detection from the true place of a robot
double worstError(const FusedRound& round) {
  double worst = 0;
  for (const detector::Detection& pose : round.detections) {
    double nearest = 1;
    for (int i = 0; i < 8; ++i) {
      const detector::Detection truth = Scene::robot(i, round.time);
      nearest = std::min(nearest, std::hypot(pose.x - truth.x, pose.y - truth.y));
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(CameraFusion, OneDetectionPerRobotInEveryRound) {
  Scene scene;
  CameraFusion fusion(2);
  for (int k = 1; k <= 50; ++k) {
    EXPECT_TRUE(fusion.add(0, k * kPeriod, scene.seen(0, k * kPeriod, 0)).empty());
    const auto rounds = fusion.add(1, k * kPeriod, scene.seen(1, k * kPeriod, 0));
    ASSERT_EQ(rounds.size(), 1U);
    EXPECT_EQ(rounds[0].detections.size(), 8U);
    EXPECT_LT(worstError(rounds[0]), 6 * kNoise);
  }
  EXPECT_EQ(fusion.counts().shared, 50 * 6);
}

TEST(CameraFusion, FindsAndRemovesAClockOffset) {
  Scene scene;
  CameraFusion fusion(2);
  constexpr double kOffset = 0.020;  // [s] 0.9 mm at 4.5 cm/s
  constexpr double kLate = 0.007;    // [s] between the exposures of the cameras
  double worst = 0;
  for (int k = 1; k <= 500; ++k) {
    const double t = k * kPeriod;
    fusion.add(0, t, scene.seen(0, t, 0));
    const double stamp = t + kLate + kOffset;
    for (const FusedRound& round : fusion.add(1, stamp, scene.seen(1, stamp, kOffset))) {
      if (k > 250) worst = std::max(worst, worstError(round));
    }
  }
  const ClockOffset found = fusion.offsets()[1];
  EXPECT_LT(found.sigma, 1e-4);
  EXPECT_NEAR(found.offset, kOffset, 5 * found.sigma);
  EXPECT_LT(worst, 3e-4);
  EXPECT_EQ(fusion.counts().shared, 500 * 6);
}

TEST(CameraFusion, MakesDifferentCalibrationsAgreeWhereViewsOverlap) {
  Scene scene;
  CameraFusion fusion(2);
  const auto errorAt = [](double x, double y) {
    return Eigen::Vector2d(8e-4 - 3e-4 * y, -6e-4 + 3e-4 * x);
  };
  for (int k = 1; k <= 1000; ++k) {
    const double t = k * kPeriod;
    fusion.add(0, t, scene.seen(0, t, 0));
    std::vector<detector::Detection> wrong = scene.seen(1, t, 0);
    for (detector::Detection& pose : wrong) {
      const Eigen::Vector2d by = errorAt(pose.x, pose.y);
      pose.x += by.x();
      pose.y += by.y();
      pose.theta += 3e-4;
    }
    EXPECT_EQ(fusion.add(1, t, wrong).at(0).detections.size(), 8U);
  }
  EXPECT_EQ(fusion.counts().rejected, 0);
  for (int i = 1; i < 7; ++i) {
    const detector::Detection robot = Scene::robot(i, 40);
    const Eigen::Vector2d found =
        fusion.errors()[1].at(robot.x, robot.y) - fusion.errors()[0].at(robot.x, robot.y);
    EXPECT_GT(errorAt(robot.x, robot.y).norm(), 6e-4);
    EXPECT_LT((found - errorAt(robot.x, robot.y)).norm(), 6e-5) << i;
  }
}

TEST(CameraFusion, DoesNotWaitForADeadCamera) {
  Scene scene;
  CameraFusion fusion(2);
  std::size_t rounds = 0;
  for (int k = 1; k <= 40; ++k) {
    const double t = k * kPeriod;
    if (k <= 10) rounds += fusion.add(1, t, scene.seen(1, t, 0)).size();
    for (const FusedRound& round : fusion.add(0, t, scene.seen(0, t, 0))) {
      ++rounds;
      EXPECT_EQ(round.detections.size(), k <= 10 ? 8U : 7U);
    }
  }
  EXPECT_FALSE(fusion.isAlive(1));
  EXPECT_EQ(rounds, 40U);  // none is lost, although five have waited
  const double t = 41 * kPeriod;
  EXPECT_TRUE(fusion.add(1, t, scene.seen(1, t, 0)).empty());
  EXPECT_TRUE(fusion.isAlive(1));
  EXPECT_EQ(fusion.add(0, t, scene.seen(0, t, 0)).at(0).detections.size(), 8U);
}

TEST(CameraFusion, ALostCameraIsNotWaitedForAtAll) {
  Scene scene;
  CameraFusion fusion(2);
  fusion.add(0, kPeriod, scene.seen(0, kPeriod, 0));
  fusion.add(1, kPeriod, scene.seen(1, kPeriod, 0));
  fusion.lose(0);
  const auto rounds = fusion.add(1, 2 * kPeriod, scene.seen(1, 2 * kPeriod, 0));
  ASSERT_EQ(rounds.size(), 1U);
  EXPECT_EQ(rounds[0].cameras, std::vector<std::size_t>{1});
  EXPECT_EQ(rounds[0].detections.size(), 7U);
}

}  // namespace
}  // namespace lab::tracker::camera_fusion_test
