#include "runner/campaign/adaptive/gaussian_process.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <utility>

namespace lab::runner::campaign {
namespace {

constexpr double kTypicalLength = 0.4;     // of the range of a key
constexpr double kLengthSpread = 0.7;      // of its logarithm
constexpr double kTypicalShare = 0.5;      // of sigma, of the scatter of the points
constexpr double kSigmaSpread = 1.2;       // of its logarithm
constexpr double kPlaneShare = 3;          // of the plane, of the scatter of the points
constexpr double kSearched = 3;            // in spreads of the priors
constexpr int kRounds = 4;                 // over all hyperparameters
constexpr int kBits = 12;                  // of each search
constexpr double kJitter = 1e-9;           // of the variance, so that points may coincide
constexpr double kSmallestScatter = 1e-9;  // of the mean, where all points are equal

/// Standard deviation of the points; positive.
double scatterOf(const Measured& measured) {
  if (measured.means.size() < 2) return 1;
  const double mean = measured.means.mean();
  const double square = (measured.means.array() - mean).square().mean();
  return std::max({std::sqrt(square), kSmallestScatter * std::abs(mean), 1e-300});
}

/// Logarithms of the lengths and of sigma with their priors.
struct LogKernel {
  Eigen::VectorXd centres;
  Eigen::VectorXd spreads;
  double plane = 0;

  LogKernel(Eigen::Index keys, double scatter)
      : centres(keys + 1), spreads(keys + 1), plane(kPlaneShare * scatter) {
    centres.head(keys).setConstant(std::log(kTypicalLength));
    spreads.head(keys).setConstant(kLengthSpread);
    centres(keys) = std::log(kTypicalShare * scatter);
    spreads(keys) = kSigmaSpread;
  }

  [[nodiscard]] double logPrior(const Eigen::VectorXd& logs) const {
    return -0.5 * ((logs - centres).array() / spreads.array()).square().sum();
  }

  [[nodiscard]] Kernel kernel(const Eigen::VectorXd& logs) const {
    const Eigen::Index keys = logs.size() - 1;
    return {logs.head(keys).array().exp(), std::exp(logs(keys)), plane};
  }
};

}  // namespace

Eigen::MatrixXd covariance(const Kernel& kernel, const Inputs& one, const Inputs& other) {
  const Eigen::ArrayXXd a = one.array() - 0.5;
  const Eigen::ArrayXXd b = other.array() - 0.5;
  // Slopes are of the scaled key from -1 to 1.
  Eigen::MatrixXd result = kernel.plane * kernel.plane *
                           (1 + 4 * (a.matrix() * b.matrix().transpose()).array()).matrix();
  const Eigen::RowVectorXd inverse = kernel.lengths.cwiseInverse().transpose();
  for (Eigen::Index i = 0; i < one.rows(); ++i) {
    for (Eigen::Index j = 0; j < other.rows(); ++j) {
      const double r = std::sqrt(5.0) * (one.row(i) - other.row(j)).cwiseProduct(inverse).norm();
      result(i, j) += kernel.sigma * kernel.sigma * (1 + r + r * r / 3) * std::exp(-r);
    }
  }
  return result;
}

GaussianProcess::GaussianProcess(Measured measured, Kernel kernel)
    : measured_(std::move(measured)), kernel_(std::move(kernel)) {
  if (measured_.means.size() == 0) return;
  offset_ = measured_.means.mean();
  Eigen::MatrixXd total = covariance(kernel_, measured_.inputs, measured_.inputs);
  const double jitter = kJitter * (kernel_.sigma * kernel_.sigma + kernel_.plane * kernel_.plane);
  total.diagonal().array() += measured_.noise.array() + jitter;
  factor_.compute(total);
  weights_ = factor_.solve((measured_.means.array() - offset_).matrix());
}

GaussianProcess GaussianProcess::fitted(const Measured& measured) {
  const LogKernel prior(measured.inputs.cols(), scatterOf(measured));
  Eigen::VectorXd logs = prior.centres;
  const auto loss = [&](const Eigen::VectorXd& at) {
    return -GaussianProcess(measured, prior.kernel(at)).logLikelihood() - prior.logPrior(at);
  };
  for (int round = 0; measured.means.size() > 0 && round < kRounds; ++round) {
    for (Eigen::Index i = 0; i < logs.size(); ++i) {
      const double half = kSearched * prior.spreads(i);
      const auto best = boost::math::tools::brent_find_minima(
          [&](double value) {
            Eigen::VectorXd at = logs;
            at(i) = value;
            return loss(at);
          },
          prior.centres(i) - half, prior.centres(i) + half, kBits);
      logs(i) = best.first;
    }
  }
  return {measured, prior.kernel(logs)};
}

Eigen::VectorXd GaussianProcess::mean(const Inputs& inputs) const {
  if (measured_.means.size() == 0) return Eigen::VectorXd::Constant(inputs.rows(), offset_);
  return ((covariance(kernel_, inputs, measured_.inputs) * weights_).array() + offset_).matrix();
}

Eigen::MatrixXd GaussianProcess::posterior(const Inputs& one, const Inputs& other) const {
  const Eigen::MatrixXd prior = covariance(kernel_, one, other);
  if (measured_.means.size() == 0) return prior;
  return prior - covariance(kernel_, one, measured_.inputs) *
                     factor_.solve(covariance(kernel_, measured_.inputs, other));
}

Eigen::VectorXd GaussianProcess::variances(const Inputs& inputs) const {
  Eigen::VectorXd variances(inputs.rows());
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    variances(i) = covariance(kernel_, inputs.row(i), inputs.row(i))(0, 0);
  }
  if (measured_.means.size() == 0) return variances;
  const Eigen::MatrixXd half =
      factor_.matrixL().solve(covariance(kernel_, measured_.inputs, inputs));
  return (variances - half.colwise().squaredNorm().transpose()).cwiseMax(0);
}

double GaussianProcess::logLikelihood() const {
  const Eigen::Index count = measured_.means.size();
  if (count == 0) return 0;
  return -factor_.matrixLLT().diagonal().array().log().sum() -
         0.5 * weights_.dot((measured_.means.array() - offset_).matrix()) -
         0.5 * static_cast<double>(count) * std::log(2 * std::numbers::pi);
}

}  // namespace lab::runner::campaign
