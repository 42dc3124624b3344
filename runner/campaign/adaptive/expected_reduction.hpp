/// By how much further runs are expected to reduce the variance of what is asked. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::runner::campaign {

/// A joint normal distribution of targets and candidates. The posterior of a Gaussian process and
/// that of a linear model both are one. Its covariance after a measurement does not depend on the
/// value that is measured, so that runs can be planned before they are made.
struct GaussianDesign {
  Eigen::VectorXd weights;     ///< of each target in the variance that is asked for
  Eigen::VectorXd variances;   ///< of each target
  Eigen::MatrixXd cross;       ///< targets x candidates: covariances
  Eigen::MatrixXd candidates;  ///< candidates x candidates: covariances
  Eigen::VectorXd noise;       ///< variance of one run at each candidate

  /// The weighted sum of the targets' variances.
  [[nodiscard]] double variance() const { return weights.dot(variances); }
};

/// The expected reduction of design.variance() by one run at each candidate: the sum over targets t
/// of w_t cov(t, c)^2 / (var(c) + noise(c)) (Cohn, Ghahramani, Jordan 1996, J. Artif. Intell. Res.
/// 4, 129, eq. 26).
[[nodiscard]] Eigen::VectorXd expectedReductions(const GaussianDesign& design);

/// The design after a run at a candidate.
void condition(GaussianDesign& design, Eigen::Index candidate);

/// A run that is worth making.
struct ChosenRun {
  std::size_t candidate = 0;
  double reduction = 0;  ///< expected, of the variance that is asked for, after the runs before it
};

/// Runs that may be made.
struct Choices {
  std::vector<double> costs;       ///< [s] of robot time, of a run at each candidate
  std::vector<std::int64_t> left;  ///< runs that may still be made of each candidate
  double time_left = 0;            ///< [s] of robot time
  std::size_t count = 1;           ///< runs that are asked for
};

/// The next runs: each has the largest expected reduction per robot time, given those before it.
/// Among equals the run with the larger reduction is taken, then the first candidate.
/// @return fewer than `count` if nothing is left that fits; `design` is that after the runs
[[nodiscard]] std::vector<ChosenRun> chooseRuns(GaussianDesign& design, Choices choices);

}  // namespace lab::runner::campaign
