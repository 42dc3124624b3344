#include "projector_ctl/scene/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "common/programs/program.hpp"

namespace lab::projector::prediction_test {
namespace {

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]
constexpr double kRate = 60;                        // [1/s]

std::int64_t at(double seconds) {
  return kStart + static_cast<std::int64_t>(std::llround(seconds * 1e6));
}

/// A robot with constant speed and turning rate.
RobotPose truth(double speed, double turn, double time) {
  const double theta = 0.3 + turn * time;
  if (turn == 0) return {speed * time * std::cos(theta), speed * time * std::sin(theta), theta};
  return {speed / turn * (std::sin(theta) - std::sin(0.3)),
          speed / turn * (std::cos(0.3) - std::cos(theta)), theta};
}

ObservedRobot seen(const RobotPose& pose, double noise = 0, double turn_noise = 0) {
  return {1, pose.x, pose.y, pose.theta, noise * noise, turn_noise * turn_noise, 1};
}

double distance(const RobotPose& a, const RobotPose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(Prediction, IsExactOnAnArc) {
  for (const double turn : {0.0, 1.5, -6.0}) {
    Track dut;
    for (int i = 0; i <= 30; ++i) dut.add(seen(truth(0.1, turn, i / kRate)), at(i / kRate));
    const RobotPose expected = truth(0.1, turn, 30 / kRate + 0.08);
    const RobotPose found = dut.predicted(at(30 / kRate + 0.08));
    EXPECT_LT(distance(found, expected), 2e-6) << turn;  // times are whole microseconds
    EXPECT_NEAR(std::remainder(found.theta - expected.theta, 2 * std::numbers::pi), 0, 1e-4);
    EXPECT_NEAR(dut.speed(), 0.1, 1e-5);
    EXPECT_NEAR(dut.turn(), turn, 1e-3);
  }
}

TEST(Prediction, FollowsAHeadingThroughPi) {
  Track dut;
  for (int i = 0; i <= 30; ++i) {
    RobotPose pose = truth(0.1, 6, i / kRate);
    pose.theta = std::remainder(pose.theta, 2 * std::numbers::pi);
    dut.add(seen(pose), at(i / kRate));
  }
  EXPECT_NEAR(dut.turn(), 6, 1e-3);
}

TEST(Prediction, OfAStandingRobotIsAsAccurateAsItsLastPose) {
  constexpr double kNoise = 0.0003;                            // [m]
  constexpr double kTurnNoise = 0.6 * std::numbers::pi / 180;  // [rad]
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double predicted = 0;
  double plain = 0;
  Track dut;
  for (int i = 0; i < 20'000; ++i) {
    const RobotPose pose{kNoise * normal(random), kNoise * normal(random),
                         kTurnNoise * normal(random)};
    dut.add(seen(pose, kNoise, kTurnNoise), at(i / kRate));
    if (i < 10) continue;
    predicted += std::pow(distance(dut.predicted(at(i / kRate + 0.08)), {}), 2);
    plain += std::pow(distance(dut.last(), {}), 2);
  }
  EXPECT_LT(predicted, plain);
}

TEST(Prediction, EndsAQuarterOfASecondAfterTheLastPose) {
  Track dut;
  for (int i = 0; i <= 30; ++i) dut.add(seen(truth(0.1, 0, i / kRate)), at(i / kRate));
  const RobotPose furthest = dut.predicted(at(30 / kRate + Track::kFurthest));
  EXPECT_EQ(distance(dut.predicted(at(30 / kRate + 2)), furthest), 0);
  EXPECT_NEAR(distance(furthest, dut.last()), 0.1 * Track::kFurthest, 1e-5);
}

TEST(Prediction, DoesNotMoveWithASinglePose) {
  Track dut;
  dut.add(seen({0.2, 0.3, 1}), at(0));
  EXPECT_EQ(distance(dut.predicted(at(0.1)), {0.2, 0.3, 1}), 0);
  EXPECT_FALSE(dut.joined());
}

TEST(Prediction, IgnoresASinglePoseOutOfReach) {
  Track dut;
  for (int i = 0; i <= 9; ++i) dut.add(seen(truth(0.1, 0, i / kRate)), at(i / kRate));
  dut.add(seen({0.7, 0.7, 0}), at(10 / kRate));
  EXPECT_LT(distance(dut.predicted(at(10 / kRate)), truth(0.1, 0, 10 / kRate)), 1e-5);
  dut.add(seen(truth(0.1, 0, 11 / kRate)), at(11 / kRate));
  EXPECT_NEAR(dut.speed(), 0.1, 1e-5);
}

TEST(Prediction, StartsANewTrackAtTwoConsistentPosesOutOfReach) {
  Track dut;
  for (int i = 0; i <= 9; ++i) dut.add(seen(truth(0.1, 0, i / kRate)), at(i / kRate));
  dut.add(seen({0.7, 0.7, 0}), at(10 / kRate));
  dut.add(seen({0.7, 0.7, 0}), at(11 / kRate));
  EXPECT_EQ(distance(dut.predicted(at(12 / kRate)), {0.7, 0.7, 0}), 0);
  EXPECT_EQ(dut.beforeUtime(), at(10 / kRate));
}

TEST(Prediction, StartsANewTrackAfterAGap) {
  Track dut;
  for (int i = 0; i <= 9; ++i) dut.add(seen(truth(0.1, 0, i / kRate)), at(i / kRate));
  dut.add(seen({0.7, 0.7, 0}), at(2));
  EXPECT_FALSE(dut.joined());
  EXPECT_EQ(distance(dut.predicted(at(2.1)), {0.7, 0.7, 0}), 0);
}

TEST(Prediction, IgnoresPosesOfLowConfidence) {
  RobotTracks dut({1, 2, 3, 4});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  dut.add({1,
           1,
           at(0),
           {{1, 0.1, 0.1, 0, 0, 0, 0.49},
            {2, nan, 0, 0, 0, 0, 1},
            {3, 0, 0, 0, 0, 0, nan},
            {4, 0.2, 0.2, 0, 0, 0, 0.5}}});
  EXPECT_EQ(dut.track(1), nullptr);
  EXPECT_EQ(dut.track(2), nullptr);
  EXPECT_EQ(dut.track(3), nullptr);
  EXPECT_NE(dut.track(4), nullptr);
}

TEST(Prediction, AReportOfAProgramExpires) {
  RobotTracks dut({1, 2});
  dut.report(1, "abp", at(0));
  EXPECT_TRUE(dut.runs(1, "abp", at(0.5), 0.5));
  EXPECT_FALSE(dut.runs(1, "abp", at(0.6), 0.5));
  EXPECT_FALSE(dut.runs(1, "bp", at(0.1), 0.5));
  EXPECT_FALSE(dut.runs(2, "abp", at(0.1), 0.5));
}

TEST(Prediction, KeepsNothingOfOtherRobots) {
  RobotTracks dut({3});
  for (const std::int32_t id : {3, 4, -1}) {
    dut.add({1, 1, at(0), {{id, 0.1, 0.1, 0, 0, 0, 1}}});
    dut.report(id, "abp", at(0));
  }
  EXPECT_NE(dut.track(3), nullptr);
  EXPECT_TRUE(dut.runs(3, "abp", at(0), 0.5));
  for (const std::int32_t id : {4, -1}) {
    EXPECT_EQ(dut.track(id), nullptr) << id;
    EXPECT_FALSE(dut.runs(id, "abp", at(0), 0.5)) << id;
  }
}

TEST(Prediction, KeepsNoNameThatNoProgramCanHave) {
  RobotTracks dut({3});
  const std::string longest(kLongestProgramName, 'a');
  dut.report(3, longest, at(0));
  EXPECT_TRUE(dut.runs(3, longest, at(0), 0.5));
  dut.report(3, longest + 'a', at(0));
  EXPECT_FALSE(dut.runs(3, longest + 'a', at(0), 0.5));
  EXPECT_FALSE(dut.runs(3, longest, at(0), 0.5)) << "it runs another program now";
}

}  // namespace
}  // namespace lab::projector::prediction_test
