#include "analyzer/collective/density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace lab::collective::density_test {
namespace {

CrowdSettings settings() {
  CrowdSettings settings;
  settings.arena = {0, 0, 1.2, 0.9};
  return settings;
}

std::vector<CrowdRobot> idealGas(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<CrowdRobot> robots;
  for (int k = 0; k < count; ++k) robots.push_back({k, 1.2 * unit(random), 0.9 * unit(random)});
  return robots;
}

double integral(const ObservableCurve& curve) {
  double sum = 0;
  for (const CurveSample& point : curve.points) sum += 0.025 * point.average.value;
  return sum;
}

TEST(DensityDistribution, IsNormalised) {
  std::mt19937_64 random(1);
  DensityDistribution dut(settings());
  for (int k = 0; k < 50; ++k) dut.add(idealGas(30, random), {0.1, 0.2, 5, units::kNan});

  EXPECT_NEAR(integral(dut.ofCells()), 1, 1e-12);
  EXPECT_NEAR(integral(dut.ofBoxes()), 1, 1e-12);
}

TEST(DensityDistribution, OfBoxesHasTheMeanOfTheCoveredArea) {
  // Robots away from walls: everything that they cover is in some box.
  std::vector<CrowdRobot> robots;
  for (int k = 0; k < 12; ++k) robots.push_back({k, 0.1 + 0.09 * k, 0.2 + 0.05 * k});
  DensityDistribution dut(settings());
  dut.add(robots, std::vector<double>(12, 0.2));

  double mean = 0;
  for (const CurveSample& point : dut.ofBoxes().points) {
    mean += point.x * 0.025 * point.average.value;
  }

  EXPECT_NEAR(mean, 12 * std::numbers::pi * 0.0375 * 0.0375 / (1.2 * 0.9), 0.0125);
}

double bimodalityOf(const std::function<double(std::mt19937_64&)>& draw) {
  std::mt19937_64 random(2);
  DensityDistribution dut(settings());
  for (int frame = 0; frame < 400; ++frame) {
    std::vector<double> densities;
    for (int k = 0; k < 50; ++k) densities.push_back(draw(random));
    dut.add({}, densities);
  }
  const Average average = dut.bimodality();
  EXPECT_LT(average.sigma, 0.02);
  return average.value;
}

TEST(Bimodality, IsSarlesCoefficient) {
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  std::normal_distribution<double> normal(0.5, 0.05);
  std::bernoulli_distribution coin(0.5);
  EXPECT_NEAR(bimodalityOf([&](auto& random) { return uniform(random); }), 5.0 / 9, 0.01);
  EXPECT_NEAR(bimodalityOf([&](auto& random) { return normal(random); }), 1.0 / 3, 0.01);
  EXPECT_NEAR(bimodalityOf([&](auto& random) { return coin(random) ? 0.2 : 0.8; }), 1, 1e-9);
}

Modes modesOfMixture(double share, double low, double high, double width) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, width);
  std::bernoulli_distribution coin(share);
  DensityDistribution dut(settings());
  for (int frame = 0; frame < 400; ++frame) {
    std::vector<double> densities;
    for (int k = 0; k < 50; ++k) {
      densities.push_back(std::abs((coin(random) ? high : low) + normal(random)));
    }
    dut.add({}, densities);
  }
  return modesOf(dut.ofCells());
}

TEST(Modes, AreThoseOfAMixture) {
  const Modes modes = modesOfMixture(0.6, 0.2, 0.7, 0.06);

  EXPECT_EQ(modes.count, 2);
  EXPECT_NEAR(modes.dilute, 0.2, 0.03);
  EXPECT_NEAR(modes.dense, 0.7, 0.03);
  EXPECT_GT(modes.depth, 0.8);
}

TEST(Modes, OfASinglePeakAreOne) {
  const Modes modes = modesOfMixture(0.5, 0.4, 0.45, 0.08);

  EXPECT_EQ(modes.count, 1);
  EXPECT_NEAR(modes.dense, 0.42, 0.05);
}

TEST(NumberFluctuations, OfAnIdealGasHaveTheVarianceOfTheMean) {
  std::mt19937_64 random(4);
  NumberFluctuations dut(settings());
  for (int k = 0; k < 4000; ++k) dut.add(idealGas(60, random));

  const ObservableCurve curve = dut.variance();

  ASSERT_GE(curve.points.size(), 6U);
  for (const CurveSample& point : curve.points) {
    EXPECT_LT(std::abs(point.average.value - point.x) / point.average.sigma, 4) << point.x;
  }
  const Average exponent = dut.exponent();
  EXPECT_LT(std::abs(exponent.value - 0.5) / exponent.sigma, 4);
  EXPECT_LT(exponent.sigma, 0.01);
}

TEST(NumberFluctuations, OfALatticeAreFarBelow) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  NumberFluctuations dut(settings());
  for (int k = 0; k < 100; ++k) {
    // One robot somewhere in each cell of about 2.5 cm: only cells at the sides of a box fluctuate.
    std::vector<CrowdRobot> robots;
    for (int row = 0; row < 35; ++row) {
      for (int column = 0; column < 47; ++column) {
        robots.push_back({row * 47 + column, 1.2 * (column + unit(random)) / 47,
                          0.9 * (row + unit(random)) / 35});
      }
    }
    dut.add(robots);
  }

  const ObservableCurve curve = dut.variance();
  for (const CurveSample& point : curve.points) {
    EXPECT_LT(point.average.value, 3 * std::sqrt(point.x)) << point.x;
    EXPECT_LT(point.average.value, 0.6 * point.x) << point.x;
  }
  EXPECT_LT(dut.exponent().value, 0.35);
}

TEST(NumberFluctuations, OfOneFlockAreGiant) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  NumberFluctuations dut(settings());
  for (int k = 0; k < 2000; ++k) {
    // All robots within 5 cm of a random place.
    const double x = 0.05 + 1.1 * unit(random);
    const double y = 0.05 + 0.8 * unit(random);
    std::vector<CrowdRobot> robots;
    for (int i = 0; i < 60; ++i) {
      robots.push_back({i, x + 0.05 * unit(random), y + 0.05 * unit(random)});
    }
    dut.add(robots);
  }

  // The number in a box is 60 or 0: its variance is 60 times its mean.
  const CurveSample largest = dut.variance().points.back();
  EXPECT_NEAR(largest.average.value / (60 * largest.x), 1, 0.15);
}

}  // namespace
}  // namespace lab::collective::density_test
