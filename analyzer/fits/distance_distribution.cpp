#include "analyzer/fits/distance_distribution.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "analyzer/curves/statistics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {

DistanceDistribution::DistanceDistribution(const Eigen::MatrixXd& scatter,
                                           const Eigen::MatrixXd& weights,
                                           const Eigen::MatrixXd& nuisance, int recordings,
                                           double rare)
    : form_(weights),
      dimensions_(static_cast<int>(weights.rows() - nuisance.cols())),
      recordings_(recordings),
      rare_(rare) {
  if (nuisance.cols() > 0) {
    const Eigen::MatrixXd weighted = weights * nuisance;
    // Scaled, because the directions differ by orders of magnitude.
    const Eigen::VectorXd norms =
        (nuisance.cwiseProduct(weighted)).colwise().sum().cwiseMax(1e-300).cwiseSqrt();
    const Eigen::MatrixXd unit = weighted * norms.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd square = unit.transpose() * nuisance * norms.cwiseInverse().asDiagonal();
    form_ -= unit * square.ldlt().solve(unit.transpose());
  }
  const Eigen::MatrixXd product = form_ * scatter;
  const double mean = product.trace();
  scale_ = (product * product).trace() / mean;
  freedom_ = mean / scale_;
}

double DistanceDistribution::distance2(const Eigen::VectorXd& deviation) const {
  return deviation.dot(form_ * deviation);
}

double DistanceDistribution::tail(double distance2) const {
  const double freedom = recordings_ - 1;
  const double rest = freedom - freedom_ + 1;
  if (!(freedom_ > 0) || !(rest > 0)) return units::kNan;
  const double usual = fisherTail(distance2 / scale_ * rest / (freedom * freedom_), freedom_, rest);
  if (usual >= rare_) return usual;
  return std::max(usual, std::min(rare_, hotellingTail(distance2, dimensions_, freedom)));
}

}  // namespace lab::analysis
