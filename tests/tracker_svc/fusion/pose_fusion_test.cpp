#include "tracker_svc/fusion/pose_fusion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace lab::tracker::pose_fusion_test {
namespace {

detector::Detection poseAt(double x, double y, double theta, double sigma_x, double sigma_y,
                           double sigma_theta) {
  detector::Detection pose;
  pose.x = x;
  pose.y = y;
  pose.theta = theta;
  pose.covariance = {sigma_x * sigma_x, 0, 0, sigma_y * sigma_y, 0, sigma_theta * sigma_theta};
  pose.quality = 1;
  pose.used = detector::kUsedBig | detector::kUsedSmall;
  return pose;
}

TEST(FusePoses, WeightsByTheInverseCovariances) {
  // Variances 1 and 4 (mm^2): weights 4/5 and 1/5, variance 4/5.
  const std::array<detector::Detection, 2> poses{poseAt(0.100, 0.2, 3.13, 0.001, 0.002, 0.01),
                                                 poseAt(0.105, 0.2, -3.13, 0.002, 0.001, 0.01)};
  const detector::Detection fused = fusePoses(poses);
  EXPECT_NEAR(fused.x, 0.101, 1e-12);
  EXPECT_NEAR(fused.y, 0.2, 1e-12);
  EXPECT_NEAR(std::abs(fused.theta), M_PI, 1e-12);
  EXPECT_NEAR(fused.covariance[0], 0.8e-6, 1e-15);
  EXPECT_NEAR(fused.covariance[3], 0.8e-6, 1e-15);
  EXPECT_NEAR(fused.covariance[5], 0.5e-4, 1e-12);
}

TEST(FusePoses, CorrelatedErrorsAreUncorrelatedByTwoViews) {
  // The inverses of [2 1; 1 2] and [2 -1; -1 2] are [2 -1; -1 2]/3 and [2 1; 1 2]/3: sum 4/3.
  std::array<detector::Detection, 2> poses{poseAt(0, 0, 0, 1, 1, 1), poseAt(0, 0, 0, 1, 1, 1)};
  poses[0].covariance = {2, 1, 0, 2, 0, 1};
  poses[1].covariance = {2, -1, 0, 2, 0, 1};
  const detector::Detection fused = fusePoses(poses);
  EXPECT_NEAR(fused.covariance[0], 0.75, 1e-12);
  EXPECT_NEAR(fused.covariance[1], 0, 1e-12);
  EXPECT_NEAR(fused.covariance[3], 0.75, 1e-12);
}

TEST(FusePoses, ErrorsHaveTheReportedCovariance) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 4000;
  double nees = 0;
  for (int i = 0; i < kTrials; ++i) {
    const std::array<detector::Detection, 3> poses{
        poseAt(1e-3 * normal(random), 2e-3 * normal(random), 0, 1e-3, 2e-3, 0.01),
        poseAt(3e-3 * normal(random), 1e-3 * normal(random), 0, 3e-3, 1e-3, 0.01),
        poseAt(2e-3 * normal(random), 2e-3 * normal(random), 0, 2e-3, 2e-3, 0.01)};
    const detector::Detection fused = fusePoses(poses);
    nees += fused.x * fused.x / fused.covariance[0] + fused.y * fused.y / fused.covariance[3];
  }
  // Chi-square with 2 x 4000 degrees of freedom has mean 8000 and standard deviation 126.
  EXPECT_NEAR(nees, 2 * kTrials, 5 * std::sqrt(4.0 * kTrials));
}

TEST(FuseSightings, JoinsCamerasButNeverTwoPosesOfOneCamera) {
  const std::vector<Sighting> sightings{{0, poseAt(0.2, 0.2, 0, 1e-4, 1e-4, 1e-3)},
                                        {0, poseAt(0.21, 0.2, 0, 1e-4, 1e-4, 1e-3)},
                                        {1, poseAt(0.2001, 0.2, 0, 1e-4, 1e-4, 1e-3)},
                                        {1, poseAt(0.6, 0.2, 0, 1e-4, 1e-4, 1e-3)}};
  const std::vector<FusedPose> robots = fuseSightings(sightings, {});
  ASSERT_EQ(robots.size(), 3U);
  EXPECT_EQ(robots[0].sightings, (std::vector<std::size_t>{0, 2}));
  EXPECT_NEAR(robots[0].pose.x, 0.20005, 1e-12);
  EXPECT_EQ(robots[1].sightings, std::vector<std::size_t>{1});
  EXPECT_EQ(robots[2].sightings, std::vector<std::size_t>{3});
}

TEST(FuseSightings, RejectsWhatContradictsTheBestPose) {
  const std::vector<Sighting> sightings{{0, poseAt(0.2, 0.2, 0, 2e-4, 2e-4, 1e-3)},
                                        {1, poseAt(0.21, 0.2, 0, 1e-4, 1e-4, 1e-3)},
                                        {2, poseAt(0.21, 0.2, M_PI, 1e-4, 2e-4, 1e-3)}};
  const std::vector<FusedPose> robots = fuseSightings(sightings, {});
  ASSERT_EQ(robots.size(), 1U);
  EXPECT_EQ(robots[0].rejected, 2U);
  EXPECT_EQ(robots[0].pose.x, 0.21);
  EXPECT_EQ(robots[0].pose.theta, 0);
}

TEST(FuseSightings, GateRejectsOneInAThousand) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 20'000;
  FusionSettings settings;
  settings.calibration_error = 0;
  settings.heading_error = 0;
  int rejected = 0;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<Sighting> pair;
    for (std::size_t camera = 0; camera < 2; ++camera) {
      pair.push_back({camera, poseAt(1e-4 * normal(random), 2e-4 * normal(random),
                                     1e-2 * normal(random), 1e-4, 2e-4, 1e-2)});
    }
    rejected += static_cast<int>(fuseSightings(pair, settings).front().rejected);
  }
  EXPECT_NEAR(rejected, 20, 5 * std::sqrt(20.0));
}

TEST(FuseSightings, PrefersAFullPoseToADegradedOne) {
  Sighting degraded{0, poseAt(0.2, 0.2, 0, 1e-5, 1e-5, 1e-3)};
  degraded.pose.used = detector::kUsedBig | detector::kUsedRim;
  const std::vector<Sighting> sightings{degraded, {1, poseAt(0.2002, 0.2, 0, 1e-4, 1e-4, 1e-3)}};
  const std::vector<FusedPose> robots = fuseSightings(sightings, {});
  ASSERT_EQ(robots.size(), 1U);
  EXPECT_EQ(robots[0].pose.x, 0.2002);
  EXPECT_EQ(robots[0].rejected, 1U);
}

}  // namespace
}  // namespace lab::tracker::pose_fusion_test
