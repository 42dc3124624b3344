#include "runner/senses/virtual_senses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lab::runner::virtual_senses_test {
namespace {

constexpr double kPi = std::numbers::pi;

SenseSpec sense(SenseKind kind, double radius = 0.2) {
  SenseSpec spec;
  spec.kind = kind;
  spec.radius = radius;
  return spec;
}

/// The value of one sense for the first pose.
double firstOf(const SenseSpec& spec, const std::vector<SensedPose>& poses,
               const LightAt& light = {}) {
  return virtualSenses({spec}, poses, light).at(0).at(0);
}

const std::vector<SensedPose> kPoses{
    {1, 0.5, 0.5, kPi / 2}, {2, 0.6, 0.5, kPi}, {3, 0.5, 0.65, kPi / 2}, {4, 0.9, 0.5, 0}};

TEST(VirtualSenses, CountsNeighboursWithinTheRadius) {
  EXPECT_EQ(firstOf(sense(SenseKind::kNeighbours, 0.12), kPoses), 1);
  EXPECT_EQ(firstOf(sense(SenseKind::kNeighbours, 0.2), kPoses), 2);
  EXPECT_EQ(firstOf(sense(SenseKind::kNeighbours, 0.5), kPoses), 3);
}

TEST(VirtualSenses, WeighsTheDensityByDistance) {
  EXPECT_NEAR(firstOf(sense(SenseKind::kDensity, 0.2), kPoses), 0.5 + 0.25, 1e-12);
}

TEST(VirtualSenses, GivesTheMeanHeadingRelativeToTheOwn) {
  // Robot 2 heads +90 degrees from robot 1, robot 3 heads as robot 1: the mean is +45 degrees.
  EXPECT_NEAR(firstOf(sense(SenseKind::kMeanHeading, 0.2), kPoses), kPi / 4, 1e-12);
  EXPECT_EQ(firstOf(sense(SenseKind::kMeanHeading, 0.05), kPoses), 0) << "no neighbour";
}

TEST(VirtualSenses, GivesDistanceAndBearingOfTheNearestRobot) {
  // Robot 2 is 10 cm to the right of robot 1, which heads along y.
  EXPECT_NEAR(firstOf(sense(SenseKind::kNearestDistance, 0.5), kPoses), 10, 1e-9);
  EXPECT_NEAR(firstOf(sense(SenseKind::kNearestBearing, 0.5), kPoses), -kPi / 2, 1e-12);
  EXPECT_NEAR(firstOf(sense(SenseKind::kNearestDistance, 0.05), kPoses), 5, 1e-9)
      << "the radius if there is none";
}

TEST(VirtualSenses, GivesDistanceAndBearingOfAPlace) {
  SenseSpec place = sense(SenseKind::kPlaceDistance);
  place.x = 0.5;
  place.y = 0.2;
  EXPECT_NEAR(firstOf(place, kPoses), 30, 1e-9);
  place.kind = SenseKind::kPlaceBearing;
  EXPECT_NEAR(std::abs(firstOf(place, kPoses)), kPi, 1e-12) << "behind the robot";
}

TEST(VirtualSenses, GivesTheGradientOfTheLight) {
  const LightAt light = [](double x, double y) { return 0.3 * x + 0.4 * y; };  // 0.5 per metre
  EXPECT_NEAR(firstOf(sense(SenseKind::kGradient), kPoses, light), 0.005, 1e-12) << "per cm";
  EXPECT_NEAR(firstOf(sense(SenseKind::kGradientBearing), kPoses, light),
              std::atan2(0.4, 0.3) - kPi / 2, 1e-9);
  EXPECT_EQ(firstOf(sense(SenseKind::kGradient), kPoses), 0) << "dark";
}

TEST(VirtualSenses, WritesEachValueToItsIndex) {
  SenseSpec first = sense(SenseKind::kNeighbours, 0.2);
  first.index = 5;
  const auto values = virtualSenses({first}, kPoses, {});
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values[0][5], 2);
  EXPECT_EQ(values[0][0], 0);
  EXPECT_EQ(values[3][5], 0);
}

TEST(VirtualSenses, ComputesExpressionsOfTheOthers) {
  SenseSpec distance = sense(SenseKind::kNearestDistance, 0.5);
  distance.index = 2;
  SenseSpec bearing = sense(SenseKind::kNearestBearing, 0.5);
  bearing.index = 5;
  SenseSpec sideways;
  sideways.kind = SenseKind::kExpression;
  sideways.index = 1;
  sideways.value = "sense(2)*sin(sense(5))";
  SenseSpec inverse = sideways;
  inverse.index = 0;
  inverse.value = "1/(sense(2) - sense(2))";

  const SenseValues dut = virtualSenses({sideways, distance, inverse, bearing}, kPoses, {}).at(0);

  EXPECT_NEAR(dut[1], -10, 1e-9) << "robot 2 is 10 cm to the right";
  EXPECT_EQ(dut[0], 0) << "no finite number";
}

}  // namespace
}  // namespace lab::runner::virtual_senses_test
