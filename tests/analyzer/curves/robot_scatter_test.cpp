#include "analyzer/curves/robot_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analyzer/curves/statistics.hpp"

namespace lab::analysis::robot_scatter_test {
namespace {

/// How often the 95 % interval of the weighted mean of robots contains the truth, if the robots
/// differ by `between` and each is known to `within` for weight 1.
double coverage(const std::vector<double>& weights, double between, double within) {
  constexpr int kSets = 4000;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int covered = 0;
  for (int set = 0; set < kSets; ++set) {
    std::vector<double> values;
    double all = 0;
    double mean = 0;
    for (const double weight : weights) {
      values.push_back(between * normal(random) + within / std::sqrt(weight) * normal(random));
      mean += weight * values.back();
      all += weight;
    }
    mean /= all;
    const RobotScatter dut = scatterOfRobots(values, weights);
    covered += std::abs(mean) <= studentQuantile95(dut.freedom) * dut.sigma ? 1 : 0;
  }
  return static_cast<double>(covered) / kSets;
}

TEST(RobotScatter, HasTheStatedCoverageForEqualAndForDifferentRobots) {
  const std::vector<double> equal(4, 1);
  const std::vector<double> unequal{1, 2, 1.5, 3, 2, 1};
  for (const std::vector<double>& weights : {equal, unequal}) {
    for (const double between : {0.0, 1.0, 10.0}) {
      EXPECT_NEAR(coverage(weights, between, 1), 0.95, 0.02) << weights.size() << " " << between;
    }
  }
}

TEST(RobotScatter, LeavesOutRobotsWithoutAValue) {
  const std::vector<double> values{1, std::nan(""), 3};
  const std::vector<double> weights{1, 5, 1};
  EXPECT_DOUBLE_EQ(scatterOfRobots(values, weights).sigma, 1);
  EXPECT_TRUE(std::isnan(scatterOfRobots({values.data(), 1}, {weights.data(), 1}).sigma));
}

// The duration of tumbles of robots whose clocks differ: each is known to a microsecond.
TEST(RobotScatter, WidensAPooledIntervalToTheScatter) {
  Estimate pool{"tau_t", "s", 0.5004, 1e-9, 0.5004 - 2e-9, 0.5004 + 2e-9, 0.5, 4, ""};
  std::vector<Estimate> robots(4, pool);
  const double values[] = {0.4981, 0.4996, 0.5011, 0.5028};
  std::vector<const Estimate*> pointers;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    robots[i].value = values[i];
    pointers.push_back(&robots[i]);
  }
  widenByRobots(pool, pointers, std::vector<double>(4, 1));

  EXPECT_NEAR(pool.sigma, 0.001, 0.0002);
  EXPECT_LT(pool.low95, 0.5);
  EXPECT_GT(pool.high95, 0.502);
}

TEST(RobotScatter, DoesNotNarrowAnInterval) {
  Estimate pool{"v", "m/s", 0.03, 0.001, 0.028, 0.032, 0.03, 4, ""};
  const Estimate robot = pool;
  widenByRobots(pool, std::vector<const Estimate*>{&robot, &robot}, std::vector<double>{1, 1});

  EXPECT_EQ(pool.sigma, 0.001);
  EXPECT_EQ(pool.low95, 0.028);
}

}  // namespace
}  // namespace lab::analysis::robot_scatter_test
