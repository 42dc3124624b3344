/// The distribution of a squared distance between curves and a law if the law is right.
#pragma once

#include <Eigen/Core>

namespace lab::analysis {

/// For s = d' W d, where d has the covariance `scatter`, known from a number of simulated
/// recordings, and W is the inverse of that covariance with more terms added (systematic errors of
/// real recordings), after the best values of `nuisance` directions are removed from d.
///
/// With nothing added, s has Hotelling's distribution. Added terms make s smaller: then s is nearly
/// distributed as a multiple of it with fewer dimensions, with the same mean and variance
/// (Satterthwaite 1946). p-values by it are uniform if the law is right. In a share `rare` of
/// recordings, d has the added terms too: then a p-value below this share is the one by Hotelling's
/// distribution, but at most `rare`.
class DistanceDistribution {
 public:
  /// @param weights W, symmetric
  /// @param nuisance one direction per column; none: no columns
  DistanceDistribution(const Eigen::MatrixXd& scatter, const Eigen::MatrixXd& weights,
                       const Eigen::MatrixXd& nuisance, int recordings, double rare);

  /// s of a deviation d.
  [[nodiscard]] double distance2(const Eigen::VectorXd& deviation) const;

  /// The probability of at least this distance.
  [[nodiscard]] double tail(double distance2) const;

 private:
  Eigen::MatrixXd form_;  ///< W after the removal.
  int dimensions_;        ///< After the removal.
  int recordings_;
  double rare_;
  double scale_ = 1;
  double freedom_ = 0;
};

}  // namespace lab::analysis
