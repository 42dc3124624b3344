#include "runner/campaign/power_law.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "common/math/units.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kMostSteps = 100;
constexpr double kConverged = 1e-10;

bool isPositive(double value) { return std::isfinite(value) && value > 0; }

double studentQuantile(double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), 0.975);
}

/// The solution of one fit, in logarithms: the prefactor's first.
struct Solution {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;  ///< for the stated errors
  double chi2 = 0;
  int freedom = 0;
};

std::optional<Solution> solve(const std::vector<PowerLawPoint>& points) {
  if (points.empty()) return {};
  const auto rows = static_cast<Eigen::Index>(points.size());
  const auto columns = static_cast<Eigen::Index>(points.front().keys.size() + 1);
  if (rows <= columns) return {};
  Eigen::MatrixXd x(rows, columns);
  Eigen::VectorXd y(rows);
  Eigen::VectorXd weight(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const PowerLawPoint& point = points[static_cast<std::size_t>(i)];
    if (!isPositive(point.value) || !isPositive(point.sigma)) return {};
    x(i, 0) = 1;
    for (Eigen::Index k = 1; k < columns; ++k) {
      const double key = point.keys[static_cast<std::size_t>(k - 1)];
      if (!isPositive(key)) return {};
      x(i, k) = std::log(key);
    }
    y(i) = point.value;
    const double relative = point.sigma / point.value;
    weight(i) = 1 / (relative * relative);
  }
  // Fisher's scoring from the least squares of logarithms.
  const Eigen::MatrixXd information = x.transpose() * weight.asDiagonal() * x;
  const Eigen::FullPivLU<Eigen::MatrixXd> decomposed(information);
  if (!decomposed.isInvertible()) return {};
  Eigen::VectorXd beta =
      decomposed.solve(x.transpose() * weight.cwiseProduct(y.array().log().matrix()));
  Eigen::VectorXd relative;
  for (int step = 0; step < kMostSteps; ++step) {
    relative = (y.array() / (x * beta).array().exp() - 1).matrix();
    const Eigen::VectorXd change = decomposed.solve(x.transpose() * weight.cwiseProduct(relative));
    beta += change;
    if (change.cwiseAbs().maxCoeff() < kConverged) break;
  }
  relative = (y.array() / (x * beta).array().exp() - 1).matrix();
  if (!beta.allFinite()) return {};
  return Solution{beta, decomposed.inverse(), relative.cwiseAbs2().dot(weight),
                  static_cast<int>(rows - columns)};
}

/// From the logarithm of the prefactor, and the exponents as they are.
PowerLaw lawOf(const Eigen::VectorXd& parameters, const Eigen::VectorXd& sigmas, double quantile) {
  PowerLaw law;
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const double value = parameters(i);
    const double half = quantile * sigmas(i);
    if (i == 0) {
      law.prefactor = {std::exp(value), std::exp(value) * sigmas(i), std::exp(value - half),
                       std::exp(value + half)};
    } else {
      law.exponents.push_back({value, sigmas(i), value - half, value + half});
    }
  }
  return law;
}

}  // namespace

std::optional<PowerLaw> fitPowerLaw(const std::vector<PowerLawPoint>& points) {
  const std::optional<Solution> solution = solve(points);
  if (!solution) return {};
  const double dispersion = solution->chi2 / solution->freedom;
  const Eigen::VectorXd sigmas =
      (solution->covariance.diagonal() * std::max(1.0, dispersion)).cwiseSqrt();
  PowerLaw law = lawOf(solution->parameters, sigmas, studentQuantile(solution->freedom));
  law.chi2 = solution->chi2;
  law.freedom = solution->freedom;
  law.p =
      boost::math::cdf(boost::math::complement(boost::math::chi_squared(law.freedom), law.chi2));
  return law;
}

std::optional<PowerLaw> fitPowerLawBySets(const std::vector<std::vector<PowerLawPoint>>& sets) {
  constexpr std::size_t kFewestSets = 3;
  if (sets.size() < kFewestSets) return {};
  std::vector<Eigen::VectorXd> each;
  for (const std::vector<PowerLawPoint>& set : sets) {
    const std::optional<Solution> solution = solve(set);
    if (!solution) return {};
    each.push_back(solution->parameters);
  }
  const auto count = static_cast<double>(each.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(each.front().size());
  for (const Eigen::VectorXd& one : each) mean += one / count;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(mean.size());
  for (const Eigen::VectorXd& one : each) squares += (one - mean).cwiseAbs2();
  PowerLaw law =
      lawOf(mean, (squares / (count - 1) / count).cwiseSqrt(), studentQuantile(count - 1));
  law.chi2 = units::kNan;
  law.p = units::kNan;
  return law;
}

}  // namespace lab::runner::campaign
