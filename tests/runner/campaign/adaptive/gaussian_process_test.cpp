#include "runner/campaign/adaptive/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::runner::campaign::gaussian_process_test {
namespace {

Eigen::VectorXd vectorOf(std::initializer_list<double> values) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) vector(i++) = value;
  return vector;
}

/// Points of one key.
Inputs placesAt(std::initializer_list<double> values) { return vectorOf(values); }

Kernel maternKernel() { return {vectorOf({0.5}), 2, 0}; }

TEST(GaussianProcess, HasMaternsCovariance) {
  const Eigen::MatrixXd k = covariance(maternKernel(), placesAt({0.2, 0.7}), placesAt({0.2, 0.7}));

  EXPECT_DOUBLE_EQ(k(0, 0), 4);
  // 4 (1 + r + r^2 / 3) exp(-r) with r = sqrt(5).
  EXPECT_NEAR(k(0, 1), 2.0959764353272816, 1e-12);
  EXPECT_DOUBLE_EQ(k(1, 0), k(0, 1));
}

TEST(GaussianProcess, HasALengthForEachKey) {
  const Kernel kernel{vectorOf({0.5, 1.0}), 1, 0};
  Inputs origin(1, 2);
  origin << 0, 0;
  Inputs others(2, 2);
  others << 0.3, 0, 0, 0.6;

  const Eigen::MatrixXd k = covariance(kernel, origin, others);

  EXPECT_DOUBLE_EQ(k(0, 0), k(0, 1));
}

TEST(GaussianProcess, GoesThroughPointsWithoutNoise) {
  const GaussianProcess process(
      {placesAt({0.1, 0.5, 0.8}), vectorOf({3, -1, 2}), vectorOf({0, 0, 0})}, maternKernel());

  const Eigen::VectorXd mean = process.mean(placesAt({0.1, 0.5, 0.8}));
  EXPECT_NEAR(mean(0), 3, 1e-6);
  EXPECT_NEAR(mean(1), -1, 1e-6);
  EXPECT_NEAR(mean(2), 2, 1e-6);
  const Eigen::MatrixXd posterior =
      process.posterior(placesAt({0.1, 0.5, 0.8}), placesAt({0.1, 0.5, 0.8}));
  EXPECT_NEAR(posterior.cwiseAbs().maxCoeff(), 0, 1e-7);
}

TEST(GaussianProcess, HasTheExactPosteriorOfTwoNoisyPoints) {
  // The formulas of two points, worked out with a 2 x 2 inverse.
  const GaussianProcess process({placesAt({0.2, 0.7}), vectorOf({1, 3}), vectorOf({0.1, 0.3})},
                                maternKernel());

  EXPECT_NEAR(process.mean(placesAt({0.4}))(0), 1.7321206398278008, 1e-7);
  EXPECT_NEAR(process.posterior(placesAt({0.4}), placesAt({0.4}))(0, 0), 0.4545608417876492, 1e-7);
  EXPECT_NEAR(process.variances(placesAt({0.4}))(0), 0.4545608417876492, 1e-7);
  EXPECT_NEAR(process.logLikelihood(), -3.6050195133397493, 1e-7);
}

TEST(GaussianProcess, WithoutDeviationsIsALinearRegression) {
  // Height and slope have the prior variance 9; each is measured twice with the variance 0.5, so
  // that it has 1 / (1/9 + 4) = 9/37; a quarter of the range from the middle, 1.25 times as much.
  const GaussianProcess process({placesAt({0, 1}), vectorOf({2, 6}), vectorOf({0.5, 0.5})},
                                {vectorOf({1}), 1e-6, 3});

  EXPECT_NEAR(process.posterior(placesAt({0.75}), placesAt({0.75}))(0, 0), 1.25 * 9 / 37, 1e-6);
  // The slope of 2 shrinks by 36/37.
  EXPECT_NEAR(process.mean(placesAt({0.75}))(0), 4 + 36.0 / 37, 1e-6);
}

TEST(GaussianProcess, IsThePriorBeforeTheFirstPoint) {
  const GaussianProcess process({Inputs(0, 1), {}, {}}, maternKernel());

  EXPECT_DOUBLE_EQ(process.posterior(placesAt({0.3}), placesAt({0.3}))(0, 0), 4);
  EXPECT_DOUBLE_EQ(process.logLikelihood(), 0);
}

TEST(GaussianProcess, FindsTheLengthOfAWave) {
  const auto wave = [](double x) { return 5 + 2 * std::sin(9 * x); };
  Measured measured{Inputs(15, 2), Eigen::VectorXd(15), Eigen::VectorXd::Constant(15, 1e-4)};
  for (Eigen::Index i = 0; i < 15; ++i) {
    measured.inputs(i, 0) = static_cast<double>(i) / 14;
    measured.inputs(i, 1) = static_cast<double>(i % 4) / 3;
    measured.means(i) = wave(measured.inputs(i, 0));
  }

  const GaussianProcess process = GaussianProcess::fitted(measured);

  // The second key has no effect.
  EXPECT_LT(process.kernel().lengths(0), 0.6);
  EXPECT_GT(process.kernel().lengths(1), 1.2);
  Inputs between(1, 2);
  between << 0.37, 0.2;
  EXPECT_NEAR(process.mean(between)(0), wave(0.37), 0.1);
  EXPECT_LT(process.posterior(between, between)(0, 0), 0.1 * 0.1);
}

}  // namespace
}  // namespace lab::runner::campaign::gaussian_process_test
