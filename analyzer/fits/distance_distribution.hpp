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
/// (Satterthwaite 1946). p-values by it are uniform if the law is right.
class DistanceDistribution {
 public:
  /// @param weights W, symmetric
  /// @param nuisance one direction per column; none: no columns
  DistanceDistribution(const Eigen::MatrixXd& scatter, const Eigen::MatrixXd& weights,
                       const Eigen::MatrixXd& nuisance, int recordings);

  /// The probability of at least this distance.
  [[nodiscard]] double tail(double distance2) const;

  /// Effective number of dimensions.
  [[nodiscard]] double freedom() const { return freedom_; }

 private:
  double scale_ = 1;
  double freedom_ = 0;
  int recordings_ = 0;
};

}  // namespace lab::analysis
