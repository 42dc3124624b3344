/// Nonlinear least squares, shared by all calibrations.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace lab::optics {

/// Minimises the sum of squared residuals, each in units of its standard deviation.
struct LeastSquaresProblem {
  int residuals = 0;  ///< number of residuals
  /// Writes the residuals at x. A residual that is not finite marks x as infeasible: the solver
  /// then takes a shorter step.
  std::function<void(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> out)> residuals_at;
  /// Writes d residual_i / d x_j to out(i, j).
  std::function<void(const Eigen::VectorXd& x, Eigen::Ref<Eigen::MatrixXd> out)> jacobian_at;
  double tolerance = 1e-10;  ///< relative reduction of the sum of squares at which to stop
  int evaluations = 100;     ///< of the residuals, at most
};

/// The Levenberg-Marquardt method of MINPACK (lmder), as ported in Eigen's unsupported modules.
[[nodiscard]] Eigen::VectorXd solveLeastSquares(const LeastSquaresProblem& problem,
                                                const Eigen::VectorXd& start);

/// Inverse of an information matrix (J^T J).
/// @param singular smallest eigenvalue allowed, after each unknown is scaled to unit information
/// @return empty if the data do not determine all unknowns
[[nodiscard]] std::optional<Eigen::MatrixXd> covarianceOf(const Eigen::MatrixXd& information,
                                                          double singular);

}  // namespace lab::optics
