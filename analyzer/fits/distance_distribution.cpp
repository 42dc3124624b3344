#include "analyzer/fits/distance_distribution.hpp"

#include <Eigen/Cholesky>

#include "analyzer/curves/statistics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

DistanceDistribution::DistanceDistribution(const Eigen::MatrixXd& scatter,
                                           const Eigen::MatrixXd& weights,
                                           const Eigen::MatrixXd& nuisance, int recordings)
    : recordings_(recordings) {
  Eigen::MatrixXd left = weights;  // after the removal
  if (nuisance.cols() > 0) {
    const Eigen::MatrixXd weighted = weights * nuisance;
    // Scaled, because the directions differ by orders of magnitude.
    const Eigen::VectorXd norms =
        (nuisance.cwiseProduct(weighted)).colwise().sum().cwiseMax(1e-300).cwiseSqrt();
    const Eigen::MatrixXd unit = weighted * norms.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd square = unit.transpose() * nuisance * norms.cwiseInverse().asDiagonal();
    left -= unit * square.ldlt().solve(unit.transpose());
  }
  const Eigen::MatrixXd product = left * scatter;
  const double mean = product.trace();
  const double half_variance = (product * product).trace();
  scale_ = half_variance / mean;
  freedom_ = mean / scale_;
}

double DistanceDistribution::tail(double distance2) const {
  const double freedom = recordings_ - 1;
  const double rest = freedom - freedom_ + 1;
  if (!(freedom_ > 0) || !(rest > 0)) return units::kNan;
  return fisherTail(distance2 / scale_ * rest / (freedom * freedom_), freedom_, rest);
}

}  // namespace lab::analysis
