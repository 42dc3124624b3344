#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "runner/campaign/adaptive/goal_state.hpp"
#include "runner/campaign/power_law.hpp"

namespace lab::runner::campaign {
namespace {

// Standard deviations of the weak priors.
constexpr double kLogPrefactorSpread = 10;
constexpr double kExponentSpread = 3;
constexpr double kLawFreedom = 10;  // of the prior that the law holds within the errors

/// The candidates as rows of a linear model of logarithms: 1, then log keys about their middle.
struct LogModel {
  Eigen::MatrixXd rows;
  Eigen::RowVectorXd middles;

  explicit LogModel(const std::vector<Candidate>& candidates) {
    const auto count = static_cast<Eigen::Index>(candidates.size());
    const auto keys = static_cast<Eigen::Index>(candidates.front().keys.size());
    rows.setOnes(count, keys + 1);
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::vector<double>& values = candidates[static_cast<std::size_t>(i)].keys;
      rows.row(i).tail(keys) =
          Eigen::Map<const Eigen::RowVectorXd>(values.data(), keys).array().log();
    }
    auto logs = rows.rightCols(keys);
    middles = (logs.colwise().minCoeff() + logs.colwise().maxCoeff()) / 2;
    logs.rowwise() -= middles;
  }
};

std::optional<PowerLaw> fitPoints(const std::vector<Candidate>& candidates,
                                  const Measurements& measurements) {
  std::vector<PowerLawPoint> points;
  for (const MeasuredPoint& point : measurements.points) {
    if (!(point.mean > 0)) continue;
    points.push_back(
        {candidates[point.candidate].keys, point.mean, std::sqrt(point.variance) * point.mean});
  }
  return fitPowerLaw(points);
}

/// Weights of the model's coefficients in what is asked: a row per target.
Eigen::MatrixXd targetsOf(LawParameter parameter, std::size_t key, const LogModel& model,
                          const std::vector<std::size_t>& places) {
  const Eigen::Index columns = model.rows.cols();
  switch (parameter) {
    case LawParameter::kExponents:
      return Eigen::MatrixXd::Identity(columns, columns).bottomRows(columns - 1);
    case LawParameter::kOneExponent:
      return Eigen::MatrixXd::Identity(columns, columns).row(1 + static_cast<Eigen::Index>(key));
    case LawParameter::kPrefactor: {
      Eigen::MatrixXd row(1, columns);
      row << 1, -model.middles;
      return row;
    }
    case LawParameter::kCurve:
      break;
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(places.size()), columns);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = model.rows.row(static_cast<Eigen::Index>(places[static_cast<std::size_t>(i)]));
  }
  return rows;
}

}  // namespace

GoalState lawState(LawParameter parameter, std::size_t key,
                   const std::vector<Candidate>& candidates, const std::vector<RunValue>& runs) {
  const LogModel model(candidates);
  const Measurements measurements = measurementsOf(candidates, runs, ErrorScale::kRelative);
  GoalState state;
  state.law = fitPoints(candidates, measurements);
  const double dispersion =
      state.law ? std::max(1.0, (kLawFreedom + state.law->chi2) /
                                    (kLawFreedom + static_cast<double>(state.law->freedom)))
                : 1;

  const Eigen::Index columns = model.rows.cols();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(columns, columns);
  precision.diagonal().setConstant(1 / (kExponentSpread * kExponentSpread));
  precision(0, 0) = 1 / (kLogPrefactorSpread * kLogPrefactorSpread);
  for (const MeasuredPoint& point : measurements.points) {
    const Eigen::RowVectorXd row = model.rows.row(static_cast<Eigen::Index>(point.candidate));
    precision += row.transpose() * row / (dispersion * point.variance);
  }
  const Eigen::MatrixXd covariance =
      precision.llt().solve(Eigen::MatrixXd::Identity(columns, columns));
  const std::vector<std::size_t> places = distinctPlaces(candidates);
  const Eigen::MatrixXd targets = targetsOf(parameter, key, model, places);
  GaussianDesign& design = state.design;
  design.weights =
      Eigen::VectorXd::Constant(targets.rows(), 1 / static_cast<double>(targets.rows()));
  design.variances = (targets * covariance * targets.transpose()).diagonal();
  design.cross = targets * covariance * model.rows.transpose();
  design.candidates = model.rows * covariance * model.rows.transpose();
  design.noise = dispersion * measurements.noise;
  if (static_cast<Eigen::Index>(measurements.points.size()) > columns) {
    state.error = std::sqrt(design.variance());
  }
  if (!state.law) return state;
  for (const std::size_t place : places) {
    const Eigen::RowVectorXd row = model.rows.row(static_cast<Eigen::Index>(place));
    double value = state.law->prefactor.value;
    for (std::size_t k = 0; k < state.law->exponents.size(); ++k) {
      value *= std::pow(candidates[place].keys[k], state.law->exponents[k].value);
    }
    const double relative = std::sqrt((row * covariance * row.transpose()).value());
    state.surface.push_back({place, value, relative * value});
  }
  return state;
}

}  // namespace lab::runner::campaign
