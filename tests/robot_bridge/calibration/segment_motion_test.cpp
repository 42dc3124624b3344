#include "robot_bridge/calibration/segment_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>

#include "tests/robot_bridge/calibration/synthetic_motor_tracks.hpp"

namespace lab::calibration {
namespace {

const Motors kMotors;
const Camera kCamera;

std::vector<TrackPoint> track(double left, double right, std::uint64_t seed) {
  return SyntheticRobot(kMotors, kCamera, seed).drive({left, right, 1}, kMotors).track;
}

Eigen::Vector2d truth(double left, double right) {
  const Motion motion = motionOf(kMotors, dutyFor({}, left, kMaxSpeed, true),
                                 dutyFor({}, right, kMaxSpeed, true), kMaxSpeed);
  return {motion.speed, motion.turn};
}

class EverySegment : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(EverySegment, IsMeasuredWithACorrectCovariance) {
  const auto [left, right] = GetParam();
  constexpr int kTries = 400;
  double chi2 = 0;
  double worst = 0;
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  for (int seed = 0; seed < kTries; ++seed) {
    const auto motion =
        fitMotion(track(left, right, static_cast<std::uint64_t>(seed)), kCamera.noise);
    ASSERT_TRUE(motion);
    const Eigen::Vector2d miss = motion->value - truth(left, right);
    const double one = miss.dot(motion->covariance.ldlt().solve(miss));
    chi2 += one;
    worst = std::max(worst, one);
    bias += motion->covariance.llt().matrixL().solve(miss);
  }
  // The mean of 400 chi-square values with two degrees of freedom is 2 +- 0.1. The largest of them
  // exceeds 25 with probability 1/700.
  EXPECT_NEAR(chi2 / kTries, 2, 0.4);
  EXPECT_LT(worst, 25);
  EXPECT_LT((bias / std::sqrt(kTries)).cwiseAbs().maxCoeff(), 4);
}

INSTANTIATE_TEST_SUITE_P(Drives, EverySegment,
                         testing::Values(std::pair{0.08, 0.08}, std::pair{-0.15, -0.15},
                                         std::pair{-0.1, 0.1}, std::pair{0.19, -0.19},
                                         std::pair{0.0, 0.13}, std::pair{-0.19, 0.0},
                                         std::pair{0.06, 0.12}, std::pair{0.0, 0.0}));

TEST(SegmentMotion, NeedsEnoughPoints) {
  auto points = track(0.1, 0.1, 1);
  points.resize(kFewestPoints - 1);
  EXPECT_FALSE(fitMotion(points, {}));
}

TEST(SegmentMotion, AllowsARotatedMarker) {
  auto points = track(0.13, 0.0, 1);
  for (TrackPoint& point : points) point.theta += 0.02;
  const auto motion = fitMotion(points, kCamera.noise);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->value[0], truth(0.13, 0)[0],
              4 * std::sqrt(motion->covariance(0, 0)) + 0.0002 * 0.065);
}

}  // namespace
}  // namespace lab::calibration
