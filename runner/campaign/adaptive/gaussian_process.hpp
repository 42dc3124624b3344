/// A Gaussian process over the swept keys. Pure functions.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace lab::runner::campaign {

/// Points as rows, each key from 0 to 1.
using Inputs = Eigen::MatrixXd;

/// The measured points.
struct Measured {
  Inputs inputs;
  Eigen::VectorXd means;
  Eigen::VectorXd noise;  ///< variance of each mean
};

/// Hyperparameters of the process.
struct Kernel {
  Eigen::VectorXd lengths;  ///< of each key
  double sigma = 1;         ///< standard deviation about the plane
  double plane = 0;         ///< standard deviation of the plane's height, and of its slopes over
                            ///< half of a key's range
};

/// Covariance of the process between points: a plane with normal coefficients, and a deviation from
/// it with Matern's covariance, nu = 5/2, and a length for each key (Rasmussen and Williams 2006,
/// eq. 4.17; chapter 2.7 for the plane).
[[nodiscard]] Eigen::MatrixXd covariance(const Kernel& kernel, const Inputs& one,
                                         const Inputs& other);

/// The process, given what was measured.
class GaussianProcess {
 public:
  /// With given hyperparameters. The mean of the prior is that of the measured points.
  GaussianProcess(Measured measured, Kernel kernel);

  /// With the most probable hyperparameters: their priors are log-normal, the length about 0.4 of
  /// the range, sigma about the scatter of the points. Maximised one by one with Brent's method.
  [[nodiscard]] static GaussianProcess fitted(const Measured& measured);

  [[nodiscard]] const Kernel& kernel() const { return kernel_; }

  [[nodiscard]] Eigen::VectorXd mean(const Inputs& inputs) const;

  /// Posterior covariance between points.
  [[nodiscard]] Eigen::MatrixXd posterior(const Inputs& one, const Inputs& other) const;

  /// The diagonal of the posterior covariance; not negative.
  [[nodiscard]] Eigen::VectorXd variances(const Inputs& inputs) const;

  /// Logarithm of the marginal likelihood (Rasmussen and Williams 2006, eq. 5.8).
  [[nodiscard]] double logLikelihood() const;

 private:
  Measured measured_;
  Kernel kernel_;
  double offset_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;  ///< inverse covariance times the deviations from the mean
};

}  // namespace lab::runner::campaign
