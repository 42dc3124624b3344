/// How the error of a run depends on its point and length. Pure functions.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lab::runner::campaign {

/// The squared error that one run stated.
struct StatedError {
  Eigen::VectorXd input;  ///< its point, each key from 0 to 1
  double duration = 0;    ///< [s]
  double variance = 0;
  double effective_samples = 0;  ///< independent samples in it; 0 or nan: not known
};

/// The variance of a run: exp(a + b . (x - 1/2)) / duration, so that it is inverse to the length
/// and, for keys that are scaled by logarithms, a power of the key. Fitted to the logarithms of the
/// stated variances by least squares with weak normal priors. The errors of single runs are noisy;
/// used as weights they would favour values that are small by chance.
class NoiseModel {
 public:
  /// @param typical variance of a run of one second, about which the prior lies
  NoiseModel(const std::vector<StatedError>& stated, Eigen::Index keys, double typical);

  [[nodiscard]] double variance(const Eigen::VectorXd& input, double duration) const;

 private:
  Eigen::VectorXd coefficients_;  ///< a, then b
};

}  // namespace lab::runner::campaign
