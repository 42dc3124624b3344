#include "light/optics/levenberg_marquardt.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <unsupported/Eigen/LevenbergMarquardt>

namespace lab::optics {
namespace {

// Relative change of x at which to stop; below it the sum of squares no longer changes either.
constexpr double kStepTolerance = 1e-13;
// Bound of the first step, in standard deviations of the residuals. Large, because the calibrations
// start far from the minimum: the first step is then the Gauss-Newton step if that is an
// improvement.
constexpr double kFirstStep = 1e6;

/// MINPACK needs at least as many residuals as unknowns: missing ones are 0.
class Functor : public Eigen::DenseFunctor<double> {
 public:
  Functor(const LeastSquaresProblem& problem, int unknowns)
      : DenseFunctor(unknowns, std::max(problem.residuals, unknowns)), problem_(problem) {}

  int operator()(const InputType& x, ValueType& residuals) const {
    residuals.setZero(values());
    problem_.residuals_at(x, residuals.head(problem_.residuals));
    return 0;
  }

  int df(const InputType& x, JacobianType& jacobian) const {
    jacobian.setZero(values(), inputs());
    problem_.jacobian_at(x, jacobian.topRows(problem_.residuals));
    return jacobian.allFinite() ? 0 : -1;  // a negative value ends the search at x
  }

 private:
  const LeastSquaresProblem& problem_;
};

}  // namespace

Eigen::VectorXd solveLeastSquares(const LeastSquaresProblem& problem,
                                  const Eigen::VectorXd& start) {
  Functor functor(problem, static_cast<int>(start.size()));
  Eigen::LevenbergMarquardt<Functor> solver(functor);
  solver.setFtol(problem.tolerance);
  solver.setXtol(kStepTolerance);
  solver.setFactor(kFirstStep);
  solver.setMaxfev(problem.evaluations);
  Eigen::VectorXd x = start;
  solver.minimize(x);
  return x;
}

std::optional<Eigen::MatrixXd> covarianceOf(const Eigen::MatrixXd& information, double singular) {
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  if (!scaled.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues()[0] > singular)) return std::nullopt;
  const auto identity = Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols());
  return scale.asDiagonal() * scaled.ldlt().solve(identity) * scale.asDiagonal();
}

}  // namespace lab::optics
