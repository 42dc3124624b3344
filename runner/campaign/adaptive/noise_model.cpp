#include "runner/campaign/adaptive/noise_model.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace lab::runner::campaign {
namespace {

constexpr double kSlopeSpread = 4;       // of the logarithm over the range of a key
constexpr double kLevelSpread = 10;      // of the logarithm, about the typical one
constexpr double kModelVariance = 0.05;  // of the logarithm, by what the model leaves out
constexpr double kUnknownSamples = 20;

}  // namespace

NoiseModel::NoiseModel(const std::vector<StatedError>& stated, Eigen::Index keys, double typical) {
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(keys + 1, keys + 1);
  precision.diagonal().setConstant(1 / (kSlopeSpread * kSlopeSpread));
  precision(0, 0) = 1 / (kLevelSpread * kLevelSpread);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(keys + 1);
  right(0) = precision(0, 0) * std::log(typical);
  for (const StatedError& one : stated) {
    if (!(one.variance > 0) || !std::isfinite(one.variance)) continue;
    Eigen::VectorXd row(keys + 1);
    row << 1, one.input.array() - 0.5;
    const double samples = one.effective_samples > 1 ? one.effective_samples : kUnknownSamples;
    // Variance of the logarithm of a chi-squared of as many degrees of freedom.
    const double weight = 1 / (2 / samples + kModelVariance);
    precision += weight * row * row.transpose();
    right += weight * std::log(one.variance * one.duration) * row;
  }
  coefficients_ = precision.llt().solve(right);
}

double NoiseModel::variance(const Eigen::VectorXd& input, double duration) const {
  return std::exp(coefficients_(0) +
                  coefficients_.tail(input.size()).dot((input.array() - 0.5).matrix())) /
         duration;
}

}  // namespace lab::runner::campaign
