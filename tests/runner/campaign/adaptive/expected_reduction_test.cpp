#include "runner/campaign/adaptive/expected_reduction.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "runner/campaign/adaptive/gaussian_process.hpp"

namespace lab::runner::campaign::expected_reduction_test {
namespace {

constexpr double kNoise = 0.2;

Measured pointsAt(const std::vector<double>& places) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Measured measured{Inputs(count, 1), Eigen::VectorXd::Zero(count),
                    Eigen::VectorXd::Constant(count, kNoise)};
  for (Eigen::Index i = 0; i < count; ++i) {
    measured.inputs(i, 0) = places[static_cast<std::size_t>(i)];
  }
  return measured;
}

const Kernel kKernel{Eigen::VectorXd::Constant(1, 0.3), 1, 0.5};
const std::vector<double> kPlaces{0, 0.2, 0.45, 0.7, 1};

/// Variance of the process at all places after measurements at some, by its definition.
double meanVariance(const std::vector<double>& measured) {
  const GaussianProcess process(pointsAt(measured), kKernel);
  const Inputs all = pointsAt(kPlaces).inputs;
  return process.posterior(all, all).diagonal().mean();
}

GaussianDesign designAfter(const std::vector<double>& measured) {
  const GaussianProcess process(pointsAt(measured), kKernel);
  const Inputs all = pointsAt(kPlaces).inputs;
  const auto count = static_cast<Eigen::Index>(kPlaces.size());
  const Eigen::MatrixXd posterior = process.posterior(all, all);
  return {Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count)), posterior.diagonal(),
          posterior, posterior, Eigen::VectorXd::Constant(count, kNoise)};
}

TEST(ExpectedReduction, IsThatOfTheProcessMeasuredThere) {
  const GaussianDesign design = designAfter({0.2, 0.7});

  const Eigen::VectorXd reductions = expectedReductions(design);

  EXPECT_NEAR(design.variance(), meanVariance({0.2, 0.7}), 1e-9);
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    EXPECT_NEAR(reductions(static_cast<Eigen::Index>(i)),
                meanVariance({0.2, 0.7}) - meanVariance({0.2, 0.7, kPlaces[i]}), 1e-7);
  }
}

TEST(ExpectedReduction, GoesOnFromAChosenRun) {
  GaussianDesign design = designAfter({0.2});

  condition(design, 4);

  EXPECT_NEAR(design.variance(), meanVariance({0.2, 1}), 1e-7);
  EXPECT_NEAR(expectedReductions(design)(3), meanVariance({0.2, 1}) - meanVariance({0.2, 1, 0.7}),
              1e-7);
}

TEST(ChooseRuns, TakesTheBestOfAllRunByRun) {
  GaussianDesign design = designAfter({0.2});
  const std::vector<double> costs{1, 1, 1, 2.5, 1.2};

  const std::vector<ChosenRun> chosen = chooseRuns(design, {costs, {9, 9, 9, 9, 9}, 100, 4});

  std::vector<double> measured{0.2};
  for (const ChosenRun& run : chosen) {
    std::size_t best = 0;
    double best_score = 0;
    const double before = meanVariance(measured);
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      std::vector<double> with = measured;
      with.push_back(kPlaces[i]);
      const double score = (before - meanVariance(with)) / costs[i];
      if (score <= best_score) continue;
      best = i;
      best_score = score;
    }
    EXPECT_EQ(run.candidate, best);
    EXPECT_NEAR(run.reduction, best_score * costs[best], 1e-7);
    measured.push_back(kPlaces[best]);
  }
  EXPECT_EQ(chosen.size(), 4U);
  EXPECT_NEAR(design.variance(), meanVariance(measured), 1e-7);
}

TEST(ChooseRuns, KeepsToTheRunsAndTheTimeThatAreLeft) {
  GaussianDesign design = designAfter({});

  const auto chosen = chooseRuns(design, {{1, 1, 1, 1, 1}, {1, 0, 2, 0, 0}, 2.5, 10});

  ASSERT_EQ(chosen.size(), 2U);
  for (const ChosenRun& run : chosen) EXPECT_TRUE(run.candidate == 0 || run.candidate == 2);
  EXPECT_TRUE(chooseRuns(design, {{1, 1, 1, 1, 1}, {1, 1, 1, 1, 1}, 0.5, 10}).empty());
}

TEST(ChooseRuns, OfEqualOnesTakesTheOneThatTellsMore) {
  // One target; a run of the second candidate has twice the length, and half the noise.
  GaussianDesign design{Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1),
                        Eigen::MatrixXd::Ones(1, 2), Eigen::MatrixXd::Zero(2, 2),
                        Eigen::VectorXd(2)};
  design.noise << 2, 1;

  EXPECT_EQ(chooseRuns(design, {{1, 2}, {1, 1}, 10, 1}).front().candidate, 1U);
}

}  // namespace
}  // namespace lab::runner::campaign::expected_reduction_test
