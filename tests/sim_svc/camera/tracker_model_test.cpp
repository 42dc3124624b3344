#include "sim_svc/camera/tracker_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lab::sim {
namespace {

TEST(TrackerModel, AddsNoiseOfTheClaimedVariance) {
  Camera camera;
  camera.position_noise = 0.0003;
  camera.heading_noise = 0.01;
  TrackerModel dut(camera, 7);
  constexpr int kFrames = 20'000;
  const dynamics::Pose truth{0.3, 0.4, 3.14};
  double x2 = 0;
  double theta2 = 0;
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(dut.begin(i));
    dut.observe(1, truth);
    const tracked_pose_t& pose = dut.frame().robots.at(0);
    x2 += std::pow(pose.x - truth.x, 2);
    theta2 += std::pow(std::remainder(pose.theta - truth.theta, 2 * std::numbers::pi), 2);
    EXPECT_LE(std::abs(pose.theta), std::numbers::pi);
    EXPECT_DOUBLE_EQ(pose.covariance[0], 9e-8);
  }
  // The relative standard error of a mean square of Gaussian noise is sqrt(2 / n).
  const double sigma = std::sqrt(2.0 / kFrames);
  EXPECT_LT(std::abs(x2 / kFrames / 9e-8 - 1), 4 * sigma);
  EXPECT_LT(std::abs(theta2 / kFrames / 1e-4 - 1), 4 * sigma);
}

TEST(TrackerModel, DropsRobotsAndFramesAtTheGivenRatesAndNumbersAllFrames) {
  Camera camera;
  camera.dropout = 0.1;
  camera.frame_loss = 0.05;
  TrackerModel dut(camera, 7);
  constexpr int kFrames = 20'000;
  int lost_frames = 0;
  int missed = 0;
  for (int i = 0; i < kFrames; ++i) {
    if (!dut.begin(i)) ++lost_frames;
    EXPECT_EQ(dut.frame().frame, i);
    dut.observe(1, {});
    missed += dut.frame().robots.empty() ? 1 : 0;
  }
  const auto deviation = [](double count, double share) {
    return std::abs(count - share * kFrames) / std::sqrt(share * (1 - share) * kFrames);
  };
  EXPECT_LT(deviation(lost_frames, 0.05), 4);
  EXPECT_LT(deviation(missed, 0.1), 4);
}

TEST(TrackerModel, AddingARobotDoesNotChangeTheNoiseOfOthers) {
  Camera camera;
  camera.position_noise = 0.001;
  TrackerModel alone(camera, 7);
  TrackerModel together(camera, 7);
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(alone.begin(i));
    static_cast<void>(together.begin(i));
    alone.observe(1, {});
    together.observe(2, {});
    together.observe(1, {});
    EXPECT_EQ(alone.frame().robots.at(0).x, together.frame().robots.at(1).x);
  }
}

}  // namespace
}  // namespace lab::sim
