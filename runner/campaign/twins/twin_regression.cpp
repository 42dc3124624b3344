#include "runner/campaign/twins/twin_regression.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace lab::runner::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMostMissing = 0.05;     // share of the twins that may lack a look
constexpr double kFarthest = 5;           // of a look, in standard deviations of the twins
constexpr double kLeastVariation = 1e-9;  // of a look, relative to its size
constexpr int kPenalties = 25;            // from 1e-4 to 1e4 of the mean square of a look

/// The looks as columns with mean 0 and standard deviation 1 over the twins.
struct StandardLooks {
  MatrixXd twins;  ///< a row each
  VectorXd run;
};

StandardLooks standardise(const std::vector<Look>& looks, std::size_t twins) {
  std::vector<VectorXd> columns;
  std::vector<double> of_run;
  for (const Look& look : looks) {
    if (!std::isfinite(look.run)) continue;
    VectorXd column = Eigen::Map<const VectorXd>(look.twins.data(), static_cast<Index>(twins));
    const auto known = [](double value) { return std::isfinite(value); };
    const auto count = std::ranges::count_if(column, known);
    if (static_cast<double>(count) < (1 - kMostMissing) * static_cast<double>(twins)) continue;
    double sum = 0;
    for (const double value : column) sum += known(value) ? value : 0;
    const double mean = sum / static_cast<double>(count);
    for (double& value : column) value = known(value) ? value - mean : 0;
    const double deviation = std::sqrt(column.squaredNorm() / static_cast<double>(count));
    if (!(deviation > kLeastVariation * std::abs(mean)) || !(deviation > 0)) continue;
    columns.push_back((column / deviation).cwiseMax(-kFarthest).cwiseMin(kFarthest));
    of_run.push_back(std::clamp((look.run - mean) / deviation, -kFarthest, kFarthest));
  }
  StandardLooks standard;
  standard.twins.resize(static_cast<Index>(twins), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    standard.twins.col(static_cast<Index>(i)) = columns[i];
  }
  standard.run = Eigen::Map<const VectorXd>(of_run.data(), static_cast<Index>(of_run.size()));
  return standard;
}

/// Predictions of one parameter, relative to its mean over the twins.
struct Prediction {
  VectorXd twins;  ///< each by the other ones
  double run = 0;
};

/// Ridge regression on the principal components of the looks. The prediction of a twin by the
/// others follows from its residual and its leverage.
class Ridge {
 public:
  explicit Ridge(const StandardLooks& looks)
      : looks_(looks), svd_(looks.twins, Eigen::ComputeThinU | Eigen::ComputeThinV) {}

  [[nodiscard]] Prediction predict(const VectorXd& parameter) const {
    Prediction best;
    double smallest = std::numeric_limits<double>::infinity();
    const auto twins = static_cast<double>(looks_.twins.rows());
    for (int i = 0; i < kPenalties; ++i) {
      const double penalty = twins * std::pow(10, -4 + 8.0 * i / (kPenalties - 1));
      const VectorXd squares = svd_.singularValues().array().square();
      const VectorXd shrink = squares.array() / (squares.array() + penalty);
      const MatrixXd& u = svd_.matrixU();
      const VectorXd scores = u.transpose() * parameter;
      const VectorXd fitted = u * shrink.cwiseProduct(scores);
      const VectorXd leverage =
          (u.array().square().matrix() * shrink).array() + 1 / twins;  // also of the mean
      const VectorXd left_out = (parameter - fitted).array() / (1 - leverage.array()).max(1e-6);
      if (left_out.squaredNorm() >= smallest) continue;
      smallest = left_out.squaredNorm();
      best.twins = parameter - left_out;
      const VectorXd weights = shrink.array() / svd_.singularValues().array().max(1e-300);
      best.run = (svd_.matrixV() * weights.cwiseProduct(scores)).dot(looks_.run);
    }
    return best;
  }

 private:
  const StandardLooks& looks_;
  Eigen::JacobiSVD<MatrixXd> svd_;
};

/// The mean predictions as a function of the parameters: a polynomial of second degree, and the
/// scatter about it.
class Response {
 public:
  Response(const MatrixXd& parameters, const MatrixXd& predicted)
      : size_(parameters.cols()),
        scale_((parameters.colwise().squaredNorm() / static_cast<double>(parameters.rows()))
                   .cwiseSqrt()
                   .transpose()) {
    MatrixXd design(parameters.rows(), termsAt(VectorXd::Zero(size_)).size());
    for (Index i = 0; i < parameters.rows(); ++i) {
      design.row(i) = termsAt(parameters.row(i).transpose().cwiseQuotient(scale_)).transpose();
    }
    fit_ = design.colPivHouseholderQr().solve(predicted);
    const MatrixXd scatter = predicted - design * fit_;
    freedom_ = static_cast<double>(design.rows() - design.cols());
    scatter_ = scatter.transpose() * scatter / freedom_;
    precision_ = static_cast<double>(design.cols()) / static_cast<double>(design.rows());
  }

  [[nodiscard]] double freedom() const { return freedom_; }

  /// The parameters at which these predictions are expected; nothing if there are none near the
  /// twins.
  [[nodiscard]] std::optional<VectorXd> invert(const VectorXd& predicted) const {
    VectorXd at = VectorXd::Zero(size_);
    for (int i = 0; i < kMostSteps; ++i) {
      const Eigen::FullPivLU<MatrixXd> slope(slopeAt(at));
      if (!slope.isInvertible()) return std::nullopt;
      const VectorXd step = slope.solve(predicted - fit_.transpose() * termsAt(at));
      at += step.cwiseMax(-kLongestStep).cwiseMin(kLongestStep);
      if (!(at.cwiseAbs().maxCoeff() < kBeyond)) return std::nullopt;
      if (step.norm() < 1e-10) break;
    }
    return at.cwiseProduct(scale_);
  }

  [[nodiscard]] MatrixXd covariance(const VectorXd& at) const {
    const MatrixXd inverse = slopeAt(at.cwiseQuotient(scale_)).inverse();
    return scale_.asDiagonal() * (inverse * scatter_ * inverse.transpose() * (1 + precision_)) *
           scale_.asDiagonal();
  }

 private:
  static constexpr int kMostSteps = 50;
  static constexpr double kLongestStep = 1;  // standard deviations of the drawn parameters
  static constexpr double kBeyond = 10;

  /// 1, the parameters, and their products.
  [[nodiscard]] static VectorXd termsAt(const VectorXd& at) {
    const Index size = at.size();
    VectorXd terms(1 + size + size * (size + 1) / 2);
    terms(0) = 1;
    terms.segment(1, size) = at;
    Index next = 1 + size;
    for (Index i = 0; i < size; ++i) {
      for (Index j = i; j < size; ++j) terms(next++) = at(i) * at(j);
    }
    return terms;
  }

  /// The derivative of each prediction (row) by each parameter.
  [[nodiscard]] MatrixXd slopeAt(const VectorXd& at) const {
    MatrixXd slope = fit_.middleRows(1, size_).transpose();
    Index next = 1 + size_;
    for (Index i = 0; i < size_; ++i) {
      for (Index j = i; j < size_; ++j) {
        slope.col(i) += fit_.row(next).transpose() * at(j);
        slope.col(j) += fit_.row(next).transpose() * at(i);
        ++next;
      }
    }
    return slope;
  }

  Index size_;
  VectorXd scale_;
  MatrixXd fit_;
  MatrixXd scatter_;
  double freedom_ = 0;
  double precision_ = 0;  ///< of the mean, relative to the scatter
};

MatrixXd covarianceOf(const TwinEstimates& estimates) {
  const auto size = static_cast<Index>(estimates.values.size());
  MatrixXd covariance(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      covariance(i, j) = estimates.correlation[a][b] * estimates.sigmas[a] * estimates.sigmas[b];
    }
  }
  return covariance;
}

void setErrors(const MatrixXd& covariance, TwinEstimates& estimates) {
  const VectorXd sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  estimates.sigmas.assign(sigma.begin(), sigma.end());
  estimates.correlation.clear();
  for (Index i = 0; i < covariance.rows(); ++i) {
    std::vector<double>& row = estimates.correlation.emplace_back();
    for (Index j = 0; j < covariance.cols(); ++j) {
      row.push_back(i == j ? 1 : covariance(i, j) / (sigma(i) * sigma(j)));
    }
  }
}

}  // namespace

TwinEstimates estimateParameters(const std::vector<Look>& looks,
                                 const std::vector<std::vector<double>>& drawn) {
  const std::size_t twins = drawn.size();
  const std::size_t count = twins > 0 ? drawn.front().size() : 0;
  if (count == 0 || twins < count * count + 4 * count + 10) {
    throw std::invalid_argument("too few twins for a regression");
  }
  const StandardLooks standard = standardise(looks, twins);
  if (standard.run.size() == 0) throw std::invalid_argument("no look varies over the twins");
  const Ridge ridge(standard);
  const auto rows = static_cast<Index>(twins);
  const auto size = static_cast<Index>(count);
  MatrixXd parameters(rows, size);
  for (Index i = 0; i < rows; ++i) {
    for (Index k = 0; k < size; ++k) {
      parameters(i, k) = drawn[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    }
  }
  const Eigen::RowVectorXd means = parameters.colwise().mean();
  parameters.rowwise() -= means;
  MatrixXd predicted(rows, size);
  VectorXd of_run(size);
  TwinEstimates estimates;
  for (Index k = 0; k < size; ++k) {
    const Prediction prediction = ridge.predict(parameters.col(k));
    predicted.col(k) = prediction.twins;
    of_run(k) = prediction.run;
    const double missed = (parameters.col(k) - prediction.twins).squaredNorm();
    estimates.known.push_back(std::max(0.0, 1 - missed / parameters.col(k).squaredNorm()));
  }
  const Response response(parameters, predicted);
  estimates.freedom = response.freedom();
  const std::optional<VectorXd> at = response.invert(of_run);
  if (!at) {
    estimates.values.assign(count, std::numeric_limits<double>::quiet_NaN());
    estimates.sigmas.assign(count, std::numeric_limits<double>::infinity());
    estimates.correlation.assign(count, std::vector<double>(count, 0));
    return estimates;
  }
  for (Index k = 0; k < size; ++k) estimates.values.push_back(means(k) + (*at)(k));
  setErrors(response.covariance(*at), estimates);
  return estimates;
}

PooledEstimates poolEstimates(const std::vector<TwinEstimates>& runs) {
  PooledEstimates pooled{runs.front(), 1};
  if (runs.size() == 1) return pooled;
  const auto size = static_cast<Index>(runs.front().values.size());
  MatrixXd information = MatrixXd::Zero(size, size);
  VectorXd weighted = VectorXd::Zero(size);
  double squares = 0;
  double freedom = 0;
  for (const TwinEstimates& run : runs) {
    const MatrixXd weight = covarianceOf(run).inverse();
    const VectorXd values = Eigen::Map<const VectorXd>(run.values.data(), size);
    information += weight;
    weighted += weight * values;
    squares += values.dot(weight * values);
    freedom += run.freedom;
    for (std::size_t k = 0; k < run.known.size(); ++k) {
      pooled.estimates.known[k] = std::max(pooled.estimates.known[k], run.known[k]);
    }
  }
  const MatrixXd covariance = information.inverse();
  const VectorXd mean = covariance * weighted;
  pooled.estimates.values.assign(mean.begin(), mean.end());
  pooled.estimates.freedom = freedom;
  setErrors(covariance, pooled.estimates);
  const double chi2 = std::max(0.0, squares - mean.dot(weighted));
  const boost::math::chi_squared distribution(static_cast<double>(size) *
                                              static_cast<double>(runs.size() - 1));
  pooled.p = boost::math::cdf(boost::math::complement(distribution, chi2));
  return pooled;
}

}  // namespace lab::runner::campaign
