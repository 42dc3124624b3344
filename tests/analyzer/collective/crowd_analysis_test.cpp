#include "analyzer/collective/crowd_analysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/analyzer/collective/simulated_crowd.hpp"

namespace lab::collective::crowd_analysis_test {
namespace {

constexpr double kFrame = 0.02;  // [s]

CrowdConfig config() {
  CrowdConfig config;
  config.settings.arena = {0, 0, 1.2, 0.9};
  return config;
}

const Observable& number(const CrowdResult& result, const std::string& name) {
  const auto found = std::find_if(result.numbers.begin(), result.numbers.end(),
                                  [&](const Observable& one) { return one.name == name; });
  EXPECT_NE(found, result.numbers.end()) << name;
  return *found;
}

const ObservableCurve& curve(const CrowdResult& result, const std::string& name) {
  const auto found = std::find_if(result.curves.begin(), result.curves.end(),
                                  [&](const ObservableCurve& one) { return one.name == name; });
  EXPECT_NE(found, result.curves.end()) << name;
  return *found;
}

/// Robots in a row, 20 cm apart, that drive along their headings.
std::vector<CrowdPose> row(double time, std::vector<double> headings, double speed) {
  std::vector<CrowdPose> poses;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const double x = 0.2 + 0.2 * static_cast<double>(i);
    poses.push_back({static_cast<int>(i) + 1, x + speed * time * std::cos(headings[i]),
                     0.45 + speed * time * std::sin(headings[i]), headings[i], 0, -1});
  }
  return poses;
}

TEST(CrowdAnalysis, MeasuresOrderAndSpeed) {
  using std::numbers::pi;
  CrowdAnalysis aligned(config());
  CrowdAnalysis opposed(config());
  for (int k = 0; k < 200; ++k) {
    aligned.addFrame(kFrame * k, kFrame, row(kFrame * k, {0.3, 0.3, 0.3, 0.3}, 0.05));
    opposed.addFrame(kFrame * k, kFrame, row(kFrame * k, {0.3, 0.3, 0.3 + pi, 0.3 - pi}, 0.02));
  }

  const CrowdResult one = aligned.results().front();
  const CrowdResult two = opposed.results().front();

  EXPECT_NEAR(number(one, "polar_order").average.value, 1, 1e-12);
  EXPECT_NEAR(number(two, "polar_order").average.value, 0, 1e-12);
  EXPECT_NEAR(number(two, "nematic_order").average.value, 1, 1e-12);
  EXPECT_NEAR(number(one, "speed").average.value, 0.05, 1e-9);
  EXPECT_NEAR(number(two, "square_speed").now, 0.02 * 0.02, 1e-9);
}

TEST(CrowdAnalysis, EvaluatesFiveFramesPerSecond) {
  CrowdAnalysis dut(config());
  for (int k = 0; k < 500; ++k) dut.addFrame(kFrame * k, kFrame, row(0, {0, 0}, 0));

  EXPECT_EQ(dut.results().front().frames, 50U);
}

TEST(CrowdAnalysis, EvaluatesEveryFrameOfASlowCamera) {
  CrowdAnalysis dut(config());
  for (int k = 0; k < 20; ++k) dut.addFrame(0.5 * k, 0.5, row(0.5 * k, {0, 0}, 0.01));

  const CrowdResult result = dut.results().front();

  EXPECT_EQ(result.frames, 20U);
  EXPECT_NEAR(number(result, "speed").average.value, 0.01, 1e-9);
}

TEST(CrowdAnalysis, SeparatesPrograms) {
  CrowdAnalysis dut(config());
  for (int k = 0; k < 100; ++k) {
    std::vector<CrowdPose> poses = row(0, {0, 0, 1, 2}, 0);
    poses[1].x = poses[0].x + 0.08;  // a cluster of two programs
    poses[0].program = poses[2].program = 4;
    poses[1].program = poses[3].program = 9;
    dut.addFrame(kFrame * k, kFrame, poses);
  }

  const std::vector<CrowdResult> results = dut.results();

  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].group, CrowdAnalysis::kAll);
  EXPECT_EQ(results[1].group, 4);
  EXPECT_EQ(results[2].group, 9);
  EXPECT_EQ(number(results[0], "largest_cluster").average.value, 2);
  EXPECT_EQ(number(results[1], "largest_cluster").average.value, 1);
  EXPECT_NEAR(number(results[1], "polar_order").average.value, std::cos(0.5), 1e-12);
}

TEST(CrowdAnalysis, HasNoResultOfASingleRobot) {
  CrowdAnalysis dut(config());
  for (int k = 0; k < 100; ++k) dut.addFrame(kFrame * k, kFrame, row(0, {0}, 0));

  EXPECT_TRUE(dut.results().empty());
  EXPECT_EQ(dut.group(CrowdAnalysis::kAll), nullptr);
}

TEST(CrowdAnalysis, NumbersTheClustersOfThePictureByTheirSize) {
  CrowdAnalysis dut(config());
  const std::vector<double> places{0.1, 0.18, 0.4, 0.48, 0.56, 0.9};
  std::vector<CrowdPose> poses;
  for (std::size_t i = 0; i < places.size(); ++i) {
    poses.push_back({static_cast<int>(i), places[i], 0.4, 0, -1, -1});
  }
  dut.addFrame(0, kFrame, poses);

  const CrowdPicture& picture = dut.picture();

  EXPECT_EQ(picture.observation.clusters, (std::vector<int>{2, 2, 1, 1, 1, 0}));
  EXPECT_EQ(picture.observation.values[kLargestCluster], 3);
  EXPECT_EQ(picture.observation.values[kClusters], 2);
  EXPECT_NEAR(picture.observation.values[kMeanCluster], (3 * 3 + 2 * 2 + 1) / 6.0, 1e-12);
}

TEST(CrowdAnalysis, LeavesOutPosesThatCannotBe) {
  CrowdAnalysis dut(config());
  std::vector<CrowdPose> poses = row(0, {0, 0}, 0);
  poses.push_back(poses.front());           // twice
  poses.push_back({77, 3, 0.4, 0, 0, -1});  // outside
  dut.addFrame(0, kFrame, poses);

  EXPECT_EQ(dut.picture().robots.size(), 2U);
  EXPECT_EQ(dut.leftOut(), 2U);
}

/// Robots on a grid, with ids from `first` on.
std::vector<CrowdPose> grid(int count, int first) {
  std::vector<CrowdPose> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({first + i, 0.06 + 0.025 * (i % 40), 0.06 + 0.025 * (i / 40), 0, -1, -1});
  }
  return poses;
}

TEST(CrowdAnalysis, TakesTheFirstThousandRobotsOfAFrame) {
  CrowdAnalysis dut(config());
  dut.addFrame(0, kFrame, grid(1002, 1));

  EXPECT_EQ(dut.picture().robots.size(), 1000U);
  EXPECT_EQ(dut.picture().robots.back().id, 1000);
  EXPECT_EQ(dut.leftOut(), 2U);
  EXPECT_EQ(dut.mostRobots(), 1002U);
}

TEST(CrowdAnalysis, TakesAnyNumberOfRobotsOneAfterTheOther) {
  CrowdAnalysis slow(config());
  for (int k = 0; k < 3000; ++k) slow.addFrame(0.2 * k, 0.2, grid(2, k + 1));
  CrowdAnalysis fast(config());
  for (int k = 0; k < 15; ++k) fast.addFrame(kFrame * k, kFrame, grid(1000, 1000 * k + 1));

  EXPECT_EQ(slow.leftOut(), 0U);
  EXPECT_EQ(slow.mostRobots(), 2U);
  EXPECT_EQ(slow.results().front().robots, 2);
  EXPECT_EQ(fast.leftOut(), 0U);
  EXPECT_EQ(fast.results().front().robots, 1000);
}

TEST(CrowdAnalysis, ForgetsTheRegionOfARobotThatWasNotSeenForMinutes) {
  for (const bool forgotten : {false, true}) {
    CrowdConfig with_places = config();
    with_places.regions = {{"left", false, 0.3, 0.45, 0, 0.6, 0.9}};
    CrowdAnalysis dut(with_places);
    const double back = forgotten ? 200 : 30;  // [s] when the robot is seen again
    for (int k = 0; k < 5 * 220; ++k) {
      const double time = 0.2 * k;
      std::vector<CrowdPose> poses{{2, 1.0, 0.4, 0, 0, -1}, {3, 0.8, 0.4, 0, 0, -1}};
      if (time < 10) poses.push_back({1, 0.2, 0.4, 0, 0, -1});
      if (time > back) poses.push_back({1, 0.9, 0.7, 0, 0, -1});
      dut.addFrame(time, 0.2, poses);
    }
    const double flux = dut.results().front().regions.flux[0][1].value;
    EXPECT_EQ(flux == 0, forgotten);
  }
}

TEST(CrowdAnalysis, GoesOnAfterTheClockWasSetBack) {
  CrowdAnalysis dut(config());
  for (int k = 0; k < 100; ++k) dut.addFrame(100 + kFrame * k, kFrame, row(0, {0, 0}, 0));
  for (int k = 0; k < 100; ++k) dut.addFrame(kFrame * k, kFrame, row(0, {0, 0}, 0));

  EXPECT_EQ(dut.results().front().frames, 20U);
  EXPECT_NEAR(number(dut.results().front(), "speed").average.value, 0, 1e-12);
}

TEST(CrowdAnalysis, GivesContactsWithTheirTimes) {
  CrowdAnalysis dut(config());
  // In contact for 2 s of every 5 s, and one robot of three.
  for (int k = 0; k < 50 * 500; ++k) {
    const double time = kFrame * k;
    std::vector<CrowdPose> poses = row(0, {0, 0, 0}, 0);
    if (std::fmod(time + 1e-9, 5) < 2) poses[1].x = poses[0].x + 0.0755;
    dut.addFrame(time, kFrame, poses);
  }

  const CrowdResult result = dut.results().front();

  EXPECT_NEAR(number(result, "touching_share").average.value, 2.0 / 3 * 2 / 5, 1e-3);
  EXPECT_NEAR(number(result, "contact_time").average.value, 2, 0.05);
  EXPECT_EQ(curve(result, "contact_times").points.size(), 1U);
  EXPECT_EQ(number(result, "wall_share").average.value, 0);
}

TEST(CrowdAnalysis, GivesTimesAndFluxesOfRegionsAndBands) {
  CrowdConfig with_places = config();
  with_places.regions = {{"left", false, 0.3, 0.45, 0, 0.6, 0.9}};
  with_places.bands = {"slow", "fast"};
  CrowdAnalysis dut(with_places);
  // A robot that is 10 s left and 30 s right, and one that stays right; light bands alike.
  for (int k = 0; k < 50 * 800; ++k) {
    const double time = kFrame * k;
    const bool left = std::fmod(time, 40) < 10;
    dut.addFrame(time, kFrame,
                 {{1, left ? 0.2 : 0.8, 0.4, 0, 0, left ? 0 : 2}, {2, 1.0, 0.4, 0, 0, 1}});
  }

  const CrowdResult result = dut.results().front();

  ASSERT_EQ(result.regions.names, (std::vector<std::string>{"left", "elsewhere"}));
  EXPECT_NEAR(result.regions.shares[0].value, 0.125, 0.002);
  EXPECT_NEAR(result.regions.flux[0][1].value, 1.0 / 40, 1e-3);
  EXPECT_NEAR(result.regions.flux[1][0].value, 1.0 / 40, 2e-3);
  EXPECT_EQ(result.regions.flux[0][0].value, 0);
  EXPECT_NEAR(result.regions.stays[0].value, 10, 0.2);
  ASSERT_EQ(result.bands.names, (std::vector<std::string>{"slow", "fast", "no band"}));
  EXPECT_NEAR(result.bands.shares[1].value, 0.5, 1e-9);
  EXPECT_NEAR(result.bands.flux[0][2].value, 1.0 / 40, 1e-3);
}

TEST(CrowdAnalysis, GivesStretchesWithBands) {
  SimulatedCrowd crowd({.robots = 20, .seed = 3});
  CrowdAnalysis dut(config());
  for (int k = 0; k < 3000; ++k) {
    crowd.step(0.2);
    dut.addFrame(0.2 * k, 0.2, crowd.poses());
  }

  const std::vector<Stretch> stretches = dut.group(CrowdAnalysis::kAll)->stretches(60);

  ASSERT_LE(stretches.size(), 60U);
  ASSERT_GE(stretches.size(), 30U);
  const Average average = number(dut.results().front(), "polar_order").average;
  int outside = 0;
  for (const Stretch& stretch : stretches) {
    EXPECT_GT(stretch.sigmas[kPolar], average.sigma);
    if (std::abs(stretch.values[kPolar] - average.value) > 2 * stretch.sigmas[kPolar]) ++outside;
  }
  EXPECT_LE(outside, 8);  // 5 % of 60, and scatter
  EXPECT_NEAR(stretches.back().end, 0.2 * 2999, 1);
}

}  // namespace
}  // namespace lab::collective::crowd_analysis_test
