#include "analyzer/collective/pair_correlations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tests/analyzer/collective/hard_discs.hpp"

namespace lab::collective::pair_correlations_test {
namespace {

const Rectangle kArena{0, 0, 1.2, 0.9};

/// The largest deviation as that of a normal number with the same probability: the errors have few
/// degrees of freedom.
double worstZ(const ObservableCurve& curve, double expected) {
  double worst = 0;
  for (const CurveSample& point : curve.points) {
    const double t = std::abs(point.average.value - expected) / point.average.sigma;
    const boost::math::students_t student(point.average.degrees_of_freedom);
    const double tail = boost::math::cdf(boost::math::complement(student, t));
    worst = std::max(worst, -boost::math::quantile(boost::math::normal(), tail));
  }
  return worst;
}

// Without correlation g = 1 at every distance, also for rings that lie mostly outside of the arena.
TEST(PairDistribution, OfAnIdealGasIsOneUpToTheWalls) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  PairCorrelations dut(kArena, 0.05, 0.9);
  for (int frame = 0; frame < 4000; ++frame) {
    std::vector<CrowdRobot> robots;
    for (int k = 0; k < 20; ++k) robots.push_back({k, 1.2 * unit(random), 0.9 * unit(random)});
    dut.add(robots);
  }

  const ObservableCurve curve = dut.distribution();

  ASSERT_EQ(curve.points.size(), 18U);
  EXPECT_LT(worstZ(curve, 1), 4);
  for (const CurveSample& point : curve.points) EXPECT_LT(point.average.sigma, 0.02);
}

TEST(PairDistribution, WithoutRobotsIsEmpty) {
  PairCorrelations dut(kArena, 0.05, 0.9);
  dut.add({});
  dut.add({{1, 0.3, 0.3}});

  EXPECT_TRUE(dut.distribution().points.empty());
  EXPECT_TRUE(dut.velocities().points.empty());
}

TEST(PairDistribution, OfACrystalHasItsShells) {
  HardDiscs crystal(36, 40, 0.6, 1);
  const double spacing = std::sqrt(std::numbers::pi / (2 * std::numbers::sqrt3 * 0.6));
  const double bin = 0.1 * spacing;
  PairCorrelations dut({0, 0, crystal.width(), crystal.height()}, bin, 2.9 * spacing);
  std::vector<CrowdRobot> robots;
  int id = 0;
  for (const auto& [x, y] : crystal.places()) robots.push_back({id++, x, y});

  dut.add(robots);

  // Neighbours at 1, sqrt 3, 2 and sqrt 7 lattice constants.
  const std::map<int, double> shells{{9, 6}, {10, 6}, {17, 6}, {19, 6}, {20, 6}, {26, 12}};
  const double density =
      static_cast<double>(robots.size() - 1) / crystal.width() / crystal.height();
  double found = 0;
  const auto points = dut.distribution().points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double inner = bin * static_cast<double>(k);
    const double ring = std::numbers::pi * bin * (2 * inner + bin);
    const double neighbours = points[k].average.value * density * ring;
    found += neighbours;
    if (!shells.contains(static_cast<int>(k))) {
      EXPECT_NEAR(neighbours, 0, 1e-9) << k;
    }
  }
  EXPECT_NEAR(found, 6 + 6 + 6 + 12, 0.4);  // 1 % for a crystal that ends at walls
}

/// The value of g at contact: a parabola of its logarithm through the bins up to 1.2 diameters.
struct Contact {
  double value = 0;
  double sigma = 0;
};
Contact contactValue(const ObservableCurve& curve) {
  std::array<std::array<double, 4>, 3> m{};
  for (const CurveSample& point : curve.points) {
    if (point.x < 1 || point.x > 1.2) continue;
    const double u = point.x - 1;
    const double relative = point.average.sigma / point.average.value;
    const double w = 1 / (relative * relative);
    const std::array<double, 3> basis{1, u, u * u};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) m[i][j] += w * basis[i] * basis[j];
      m[i][3] += w * basis[i] * std::log(point.average.value);
    }
  }
  // Cramer's rule for the first coefficient; its variance is the minor over the determinant.
  const auto minor = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    return m[a][c] * m[b][d] - m[a][d] * m[b][c];
  };
  const double m00 = minor(1, 2, 1, 2);
  const double det = m[0][0] * m00 - m[0][1] * minor(1, 2, 0, 2) + m[0][2] * minor(1, 2, 0, 1);
  const double above = m[0][3] * m00 - m[0][1] * minor(1, 2, 3, 2) + m[0][2] * minor(1, 2, 3, 1);
  const double value = std::exp(above / det);
  return {value, value * std::sqrt(m00 / det)};
}

class HardDiscFluid : public testing::TestWithParam<double> {};

// Henderson, Mol. Phys. 30, 971 (1975): g at contact = (1 - 7 phi / 16) / (1 - phi)^2.
TEST_P(HardDiscFluid, HasTheContactValueOfHenderson) {
  const double packing = GetParam();
  HardDiscs discs(20, 20, packing, 11);
  for (int k = 0; k < 800; ++k) discs.sweep();
  PairCorrelations dut({0, 0, discs.width(), discs.height()}, 0.01, 1.3);
  for (int frame = 0; frame < 1000; ++frame) {
    for (int k = 0; k < 4; ++k) discs.sweep();
    std::vector<CrowdRobot> robots;
    int id = 0;
    for (const auto& [x, y] : discs.places()) robots.push_back({id++, x, y});
    dut.add(robots);
  }
  const double henderson = (1 - 7 * packing / 16) / ((1 - packing) * (1 - packing));

  const ObservableCurve curve = dut.distribution();
  const Contact contact = contactValue(curve);

  for (const CurveSample& point : curve.points) {
    if (point.x < 1) {
      EXPECT_EQ(point.average.value, 0) << point.x;
    }
  }
  // His formula is good to 0.5 %; the parabola and 400 discs in place of infinitely many to 0.5 %.
  EXPECT_LT(contact.sigma, 0.02 * henderson);
  EXPECT_NEAR(contact.value, henderson, 4 * contact.sigma + 0.01 * henderson);
}

INSTANTIATE_TEST_SUITE_P(Packings, HardDiscFluid, testing::Values(0.1, 0.3, 0.5, 0.6));

TEST(VelocityCorrelation, IsTheMeanCosineAtEqualSpeed) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  PairCorrelations dut(kArena, 0.1, 0.5);
  for (int frame = 0; frame < 3000; ++frame) {
    std::vector<CrowdRobot> robots;
    for (int k = 0; k < 20; ++k) {
      // Headings turn by 2 rad/m along x.
      CrowdRobot robot{k, 1.2 * unit(random), 0.9 * unit(random)};
      robot.velocity_x = 0.05 * std::cos(2 * robot.x);
      robot.velocity_y = 0.05 * std::sin(2 * robot.x);
      robots.push_back(robot);
    }
    dut.add(robots);
  }

  const ObservableCurve curve = dut.velocities();

  // cos(2 dx) averaged over directions is J_0(2 r).
  ASSERT_EQ(curve.points.size(), 5U);
  for (const CurveSample& point : curve.points) {
    EXPECT_NEAR(point.average.value, std::cyl_bessel_j(0, 2 * point.x), 0.02) << point.x;
  }
}

TEST(VelocityCorrelation, OfIndependentVelocitiesIsZero) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  PairCorrelations dut(kArena, 0.1, 0.5);
  for (int frame = 0; frame < 2000; ++frame) {
    std::vector<CrowdRobot> robots;
    for (int k = 0; k < 20; ++k) {
      robots.push_back(
          {k, 1.2 * unit(random), 0.9 * unit(random), 0, normal(random), normal(random)});
    }
    robots[3].velocity_x = robots[3].velocity_y = units::kNan;  // seen for the first time
    dut.add(robots);
  }

  EXPECT_LT(worstZ(dut.velocities(), 0), 4);
}

}  // namespace
}  // namespace lab::collective::pair_correlations_test
