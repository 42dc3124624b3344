#include "analyzer/tracks/uniform_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/math/angle.hpp"

namespace lab::analysis::uniform_motion_test {
namespace {

TrackPoint pointAt(double time, double x, double y, double theta) {
  TrackPoint point;
  point.time = time;
  point.x = x;
  point.y = y;
  point.theta = theta;
  return point;
}

/// The end of a day at 100 frames/s, of which one frame in ten is lost, of a robot that turns now
/// and then.
std::vector<TrackPoint> endOfALongTrack() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise;
  std::bernoulli_distribution lost(0.1);
  std::bernoulli_distribution turns(0.01);
  std::vector<TrackPoint> track;
  double x = 1.1;
  double y = 0.7;
  double theta = 3;
  for (int i = 0; i < 20'000; ++i) {
    if (turns(random)) theta += noise(random);
    x += 3e-4 * std::cos(theta);
    y += 3e-4 * std::sin(theta);
    if (lost(random)) continue;
    track.push_back(pointAt(86'400 + 0.01 * i, x + 1e-5 * noise(random), y + 1e-5 * noise(random),
                            wrapAngle(theta + 0.01 * noise(random))));
  }
  return track;
}

TEST(SlidingMotion, IsThatOfAFitToEveryWindow) {
  const std::vector<TrackPoint> track = endOfALongTrack();
  const std::vector<double> headings = continuousHeadings(track);
  SlidingMotion dut(track, headings);
  std::size_t end = 0;
  int straight = 0;
  for (std::size_t begin = 0; begin + 4 <= track.size(); ++begin) {
    while (end < track.size() && (track[end].time < track[begin].time + 0.4 || end < begin + 4)) {
      ++end;
    }
    dut.moveTo(begin, end);
    const UniformMotion moved = dut.motion();
    const UniformMotion fitted = uniformMotion(track, begin, end);
    ASSERT_NEAR(moved.time, fitted.time, 1e-9);
    ASSERT_NEAR(moved.x, fitted.x, 1e-10);
    ASSERT_NEAR(moved.y, fitted.y, 1e-10);
    ASSERT_NEAR(moved.vx, fitted.vx, 1e-9);
    ASSERT_NEAR(moved.vy, fitted.vy, 1e-9);
    ASSERT_NEAR(moved.rms, fitted.rms, 1e-9);
    if (fitted.heading_rms > 0.05) continue;  // not a straight line
    ++straight;
    // The two means differ by a sixth of the third moment of the headings.
    const double most =
        std::sqrt(static_cast<double>(end - begin)) * std::pow(fitted.heading_rms, 3);
    ASSERT_NEAR(wrapAngle(moved.heading - fitted.heading), 0, 1e-9 + most / 5);
    ASSERT_NEAR(moved.heading_rms, fitted.heading_rms, 1e-6);
  }
  EXPECT_GT(straight, 5000);
}

TEST(UniformMotion, OfPointsOnALine) {
  std::vector<TrackPoint> track;
  for (int i = 0; i < 5; ++i) {
    track.push_back(pointAt(10 + i, 1 + 0.3 * i, 2 - 0.4 * i, 2));
  }
  const UniformMotion dut = uniformMotion(track, 0, 5);
  EXPECT_NEAR(dut.time, 12, 1e-12);
  EXPECT_NEAR(dut.x, 1.6, 1e-12);
  EXPECT_NEAR(dut.y, 1.2, 1e-12);
  EXPECT_NEAR(dut.speed(), 0.5, 1e-12);
  EXPECT_NEAR(dut.rms, 0, 1e-12);
  EXPECT_NEAR(dut.heading, 2, 1e-12);
  EXPECT_NEAR(dut.cosine(), std::cos(2 - std::atan2(-0.4, 0.3)), 1e-12);
}

TEST(ContinuousHeadings, HaveNoJumpsAtHalfATurn) {
  std::vector<TrackPoint> track(3);
  track[0].theta = 3;
  track[1].theta = -3;
  track[2].theta = 3;
  const std::vector<double> dut = continuousHeadings(track);
  EXPECT_NEAR(dut[0], 3, 1e-12);
  EXPECT_NEAR(dut[1], 2 * std::numbers::pi - 3, 1e-12);
  EXPECT_NEAR(dut[2], 3, 1e-12);
}

}  // namespace
}  // namespace lab::analysis::uniform_motion_test
