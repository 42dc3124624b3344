#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analyzer/curves/lags.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/laws/chebyshev.hpp"
#include "light/median.hpp"
#include "tests/analyzer/paper_programs.hpp"

namespace lab::analysis {
namespace {

TEST(ChebyshevSeries, InterpolatesAndIntegratesToFullPrecision) {
  std::vector<double> values;
  for (const double x : ChebyshevSeries::points(2.5, 30)) {
    values.push_back(std::cos(3 * x));
  }
  const ChebyshevSeries dut(values, 2.5);
  const ChebyshevSeries once = dut.integral();
  const ChebyshevSeries twice = once.integral();
  for (double x = 0; x <= 2.5; x += 0.1) {
    EXPECT_NEAR(dut(x), std::cos(3 * x), 1e-13);
    EXPECT_NEAR(once(x), std::sin(3 * x) / 3, 1e-13);
    EXPECT_NEAR(twice(x), (1 - std::cos(3 * x)) / 9, 1e-13);
  }
}

TEST(GaussLegendre, IsExactForPolynomialsOfDegreeTwoNMinusOne) {
  const GaussRule dut = gaussLegendre(7);
  for (int power = 0; power <= 13; ++power) {
    double sum = 0;
    for (std::size_t i = 0; i < dut.nodes.size(); ++i) {
      sum += dut.weights[i] * std::pow(dut.nodes[i], power);
    }
    EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-14);
  }
}

TEST(Median, IsTheUpperOneOfAnEvenNumber) {
  std::vector<double> odd{3, 1, 2};
  std::vector<double> even{4, 1, 3, 2};

  EXPECT_EQ(medianOf(odd), 2);
  EXPECT_EQ(medianOf(even), 3);
}

TEST(StudentQuantile, AgreesWithTheTables) {
  EXPECT_TRUE(std::isinf(studentQuantile(0.5)));
  EXPECT_NEAR(studentQuantile(1), 12.706, 1e-3);
  EXPECT_NEAR(studentQuantile(3), 3.182, 0.01);
  EXPECT_NEAR(studentQuantile(7), 2.365, 2e-3);
  EXPECT_NEAR(studentQuantile(31), 2.040, 1e-3);
  EXPECT_NEAR(studentQuantile(1e9), 1.960, 1e-3);
}

TEST(NormalDeviate, HasTheProbabilityOfStudentsT) {
  EXPECT_NEAR(normalDeviate(2.365, 7), 1.960, 5e-3);
  EXPECT_NEAR(normalDeviate(-2.131, 15), -1.960, 3e-3);
  EXPECT_NEAR(normalDeviate(4, 1e9), 4, 1e-6);
  EXPECT_LT(normalDeviate(4, 12), 3.2);
}

TEST(PoissonInterval, AgreesWithTheTables) {
  EXPECT_NEAR(poissonInterval(10).low, 4.795, 0.03);
  EXPECT_NEAR(poissonInterval(10).high, 18.39, 0.05);
  EXPECT_NEAR(poissonInterval(100).low, 81.36, 0.05);
  EXPECT_EQ(poissonInterval(0).low, 0);
  EXPECT_NEAR(poissonInterval(0).high, 3.69, 0.1);
}

TEST(FisherTail, AgreesWithTables) {
  // F(1, n) is the square of Student's t.
  EXPECT_NEAR(fisherTail(2.228 * 2.228, 1, 10), 0.05, 1e-4);
  EXPECT_NEAR(fisherTail(1, 7, 7), 0.5, 1e-12);
  EXPECT_NEAR(fisherTail(3.3258, 5, 10), 0.05, 1e-5);
  EXPECT_NEAR(fisherTail(5.6363, 5, 10), 0.01, 1e-5);
  EXPECT_EQ(fisherTail(0, 3, 4), 1);
}

TEST(HotellingTail, IsChiSquareForAKnownCovariance) {
  EXPECT_NEAR(hotellingTail(15.507, 8, 1e7), 0.05, 1e-4);
  EXPECT_GT(hotellingTail(15.507, 8, 100), 0.06);  // wider for one that is not
  EXPECT_TRUE(std::isnan(hotellingTail(1, 8, 5)));
}

TEST(DeviateOf, InvertsTheNormalTail) {
  for (const double x : {0.5, 1.0, 3.0, 8.0}) {
    EXPECT_NEAR(deviateOf(std::erfc(x / std::sqrt(2.0))), x, 1e-9);
  }
  EXPECT_EQ(std::lround(deviateOf(0)), 40);
}

TEST(LagGrid, IsAscendingAndContainsTheHoldTime) {
  for (const double fps : {10.0, 25.0, 50.0, 100.0}) {
    const std::vector<int> dut = makeLagGrid(1 / fps, 100, abpLaw(3, 0.5));
    EXPECT_EQ(dut.front(), 1);
    EXPECT_EQ(dut.back(), static_cast<int>(100 * fps));
    EXPECT_GE(dut.size(), 50U);
    EXPECT_LE(dut.size(), 60U);
    EXPECT_TRUE(std::is_sorted(dut.begin(), dut.end()));
    EXPECT_EQ(std::adjacent_find(dut.begin(), dut.end()), dut.end());
    for (const double time : {0.5, 1.0}) {
      const int frames = static_cast<int>(std::lround(time * fps));
      EXPECT_EQ(dut[nearestLag(dut, frames)], frames);
    }
  }
}

TEST(LagGrid, HasOneLagEvenForTheShortestRecording) {
  EXPECT_EQ(makeLagGrid(0.1, 0.05, abpLaw(3, 0.5)), std::vector<int>{1});
  EXPECT_EQ(makeLagGrid(0.1, 0.35, rtpLaw(1, 0.5)), (std::vector<int>{1, 2, 3}));
}

}  // namespace
}  // namespace lab::analysis
