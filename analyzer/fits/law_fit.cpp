#include "analyzer/fits/law_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "analyzer/curves/frame_phases.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/fits/distance_distribution.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kFewestDraws = 100;  // smallest number of draws or tumbles for a fit
constexpr double kFurthest = 1.6;     // limit of |ln(parameter / programmed)|: a factor of 5
constexpr double kLeastPivot = 1e-9;  // of the correlation matrix
constexpr int kMostIterations = 30;
constexpr int kRecordingsPerColumn = 4;  // smallest number for a covariance
constexpr double kConverged = 1e-9;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// One lag of one curve.
struct Column {
  double tau = 0;
  bool angular = false;
  double value = 0;
  double joined = 1;              ///< Share of the offset.
  std::size_t in_recordings = 0;  ///< Column of the simulated curves.
};

class Fit {
 public:
  Fit(const ProgramLaw& law, const MeasuredCurves& curves, const FitPlan& plan,
      const FitOptions& options)
      : law_(law), curves_(curves), options_(options), free_(freeParameters(law, options)) {
    const std::size_t n = plan.lags.size();
    for (const bool angular : {false, true}) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t lag = plan.lags[i];
        const double value = (angular ? curves.angular_msd : curves.msd)[lag];
        if (!std::isfinite(value)) continue;
        columns_.push_back({curves.lags[lag], angular, value, angular ? 1 : curves.joined[lag],
                            (angular ? n : 0) + i});
        angular_ = angular_ || angular;
      }
    }
    offset_ = free_.size();
    parameters_ = free_.size() + (angular_ ? 2 : 1);
    theta_ = Vector::Zero(static_cast<Eigen::Index>(parameters_));
    theta_(index(offset_)) = curves.offset;
    if (angular_) theta_(index(offset_ + 1)) = curves.angular_offset;
    setReference();
  }

  [[nodiscard]] std::size_t columns() const { return columns_.size(); }
  [[nodiscard]] std::size_t parameters() const { return parameters_; }
  [[nodiscard]] bool angular() const { return angular_; }

  /// The program with the fitted parameters.
  [[nodiscard]] ProgramLaw law() const { return lawAt(theta_); }
  [[nodiscard]] double offset() const { return theta_(index(offset_)); }
  [[nodiscard]] double angularOffset() const { return angular_ ? theta_(index(offset_ + 1)) : 0; }

  /// Sets the reference of relative deviations to the law at the current parameters, noise
  /// included.
  void setReference() {
    reference_ = model(theta_);
    covariance_ = Matrix::Identity(index(columns()), index(columns()));
  }

  /// Sets the covariance of deviations from recordings simulated near the current parameters, and
  /// the reference to their law: a reference that follows the fluctuations of the measurement would
  /// bias the weights.
  void setCovariance(const SimulatedCurves& recordings) {
    const Eigen::Index n = index(columns());
    // The measured tracks have ends too, but fewer.
    const double ends =
        std::min(1.0, recordings.duration * curves_.tracks / std::max(curves_.observed, 1e-9));
    const auto count = static_cast<Eigen::Index>(recordings.recordings);
    Matrix tapered(count, n);
    Matrix plain(count, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Column& c = columns_[static_cast<std::size_t>(j)];
      const double law = recordings.law[c.in_recordings];
      const double scale = errorScale(recordings, curves_.observed, curves_.segments, c.tau) / law;
      const double tapered_scale =
          taperedScale(recordings, curves_.observed, curves_.segments, c.tau) / law;
      for (int recording = 0; recording < recordings.recordings; ++recording) {
        plain(recording, j) = scale * recordings.value(recording, c.in_recordings);
        tapered(recording, j) = tapered_scale * recordings.taperedValue(recording, c.in_recordings);
      }
    }
    plain.rowwise() -= plain.colwise().mean().eval();
    tapered.rowwise() -= tapered.colwise().mean().eval();
    deviations_.resize(2 * count, n);
    for (Eigen::Index recording = 0; recording < count; ++recording) {
      deviations_.row(2 * recording) = std::sqrt(1 - ends) * tapered.row(recording);
      deviations_.row(2 * recording + 1) = std::sqrt(ends) * plain.row(recording);
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      reference_(j) = recordings.law[columns_[static_cast<std::size_t>(j)].in_recordings];
    }
    scatter_ = deviations_.transpose() * deviations_ / (recordings.recordings - 1);
    systematic_ = Matrix::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Column& c = columns_[static_cast<std::size_t>(j)];
      if (c.angular) continue;
      const double motion = 1 - offset() * c.joined / reference_(j);
      systematic_(j, j) = std::pow(options_.systematic_floor * motion, 2);
    }
    covariance_ = scatter_ + systematic_;
    addPhases();
    regularise();
  }

  /// Minimises by Gauss-Newton. False if it does not converge, or if parameters leave the allowed
  /// range.
  bool solve() {
    const Eigen::LLT<Matrix> factor(covariance_);
    if (factor.info() != Eigen::Success) return false;
    for (int i = 0; i < kMostIterations; ++i) {
      const Vector white = factor.matrixL().solve(residuals());
      jacobian_ = jacobian();
      const Matrix sensitivity = factor.matrixL().solve(jacobian_);
      const Vector norms = sensitivity.colwise().norm();
      if (!(norms.minCoeff() > 0) || !white.allFinite()) return false;
      Vector step = leastSquares(sensitivity, norms, white);
      const double length = step.cwiseProduct(norms).norm();
      double most = 0;
      for (std::size_t p = 0; p < offset_; ++p) most = std::max(most, std::abs(step(index(p))));
      if (most > 0.5) step *= 0.5 / most;
      theta_ += step;
      if (!theta_.allFinite() || theta_.head(index(offset_)).cwiseAbs().maxCoeff() > kFurthest) {
        return false;
      }
      if (length < kConverged) return true;
    }
    return true;  // converged to a small fraction of a standard error
  }

  void report(LawFit& fit, int recordings) const;

 private:
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  [[nodiscard]] ProgramLaw lawAt(const Vector& theta) const {
    ProgramLaw law = law_;
    for (std::size_t p = 0; p < free_.size(); ++p) {
      law = law.with(free_[p].name, law->parameter(free_[p].name) * std::exp(theta(index(p))));
    }
    return law;
  }

  [[nodiscard]] Vector model(const Vector& theta) const {
    const ExactLaw exact(lawAt(theta));
    Vector result(index(columns()));
    for (std::size_t j = 0; j < columns(); ++j) {
      const Column& c = columns_[j];
      result(index(j)) = c.angular ? exact.angularMsd(c.tau) + theta(index(offset_ + 1))
                                   : exact.msd(c.tau) + theta(index(offset_)) * c.joined;
    }
    return result;
  }

  [[nodiscard]] Vector residuals() const {
    const Vector now = model(theta_);
    Vector result(now.size());
    for (Eigen::Index j = 0; j < now.size(); ++j) {
      result(j) = (columns_[static_cast<std::size_t>(j)].value - now(j)) / reference_(j);
    }
    return result;
  }

  [[nodiscard]] Matrix jacobian() const {
    constexpr double kStep = 1e-4;
    Matrix result = Matrix::Zero(index(columns()), index(parameters_));
    for (std::size_t p = 0; p < offset_; ++p) {
      Vector shifted = theta_;
      shifted(index(p)) += kStep;
      const Vector above = model(shifted);
      shifted(index(p)) -= 2 * kStep;
      result.col(index(p)) = (above - model(shifted)) / (2 * kStep);
    }
    for (std::size_t j = 0; j < columns(); ++j) {
      const std::size_t offset = columns_[j].angular ? offset_ + 1 : offset_;
      result(index(j), index(offset)) = columns_[j].joined;
    }
    return result.array().colwise() / reference_.array();
  }

  /// The x that minimises (A x - b)^2. The columns of A are scaled by their norms.
  static Matrix leastSquares(const Matrix& a, const Vector& norms, const Matrix& b) {
    const Matrix scaled = a * norms.cwiseInverse().asDiagonal();
    const Eigen::LLT<Matrix> factor(scaled.transpose() * scaled);
    return norms.cwiseInverse().asDiagonal() * factor.solve(scaled.transpose() * b);
  }

  /// Adds what frames do that keep their phases of the hold.
  void addPhases() {
    const FramePhases phases(law_, curves_.frame_period, curves_.observed, curves_.tracks);
    if (!phases.matter()) return;
    Matrix deviations(FramePhases::kPhases, index(columns()));
    for (std::size_t j = 0; j < columns(); ++j) {
      const Column& c = columns_[j];
      const FramePhases::Deviations of =
          phases.of(c.angular, std::round(c.tau / curves_.frame_period));
      deviations.col(index(j)) =
          Eigen::Map<const Vector>(of.data(), FramePhases::kPhases) / reference_(index(j));
    }
    const Matrix covariance = deviations.transpose() * deviations / FramePhases::kPhases;
    scatter_ += phases.usual() * covariance;
    rare_ = FramePhases::kUnlucky;
    systematic_ += covariance;
    covariance_ += covariance;
  }

  /// Increases the diagonal of a covariance that is numerically singular.
  void regularise() {
    const Vector sd = covariance_.diagonal().cwiseSqrt();
    const Matrix correlation =
        sd.cwiseInverse().asDiagonal() * covariance_ * sd.cwiseInverse().asDiagonal();
    const Eigen::LLT<Matrix> factor(correlation);
    const Matrix& pivots = factor.matrixLLT();
    regularised_ =
        factor.info() != Eigen::Success || pivots.diagonal().minCoeff() < std::sqrt(kLeastPivot);
    if (regularised_) covariance_.diagonal() += kLeastPivot * covariance_.diagonal();
  }

  /// The change of the curves by the standard error of the robots' clocks.
  [[nodiscard]] Vector clockError() const {
    const ExactLaw slow(law().slowed(1 + kClockError));
    const ExactLaw exact(law());
    Vector clock(index(columns()));
    for (std::size_t j = 0; j < columns(); ++j) {
      const Column& c = columns_[j];
      clock(index(j)) = c.angular ? slow.angularMsd(c.tau) - exact.angularMsd(c.tau)
                                  : slow.msd(c.tau) - exact.msd(c.tau);
    }
    return clock.cwiseQuotient(reference_) / std::sqrt(curves_.tracks);
  }

  /// The distance of the curves from the law with its p-value. The rate of the robots' clocks is
  /// free within its error. Otherwise an error of 1 % would be a misfit in an hour, because the
  /// times of the program are given.
  void setGoodness(LawFit& fit, int recordings) const {
    Matrix whole = covariance_;
    const Vector clock = clockError();
    whole += clock * clock.transpose();
    const Eigen::LLT<Matrix> factor(whole);
    const Matrix weights = factor.solve(Matrix::Identity(whole.rows(), whole.cols()));
    const Vector left = residuals();
    const Matrix scatter = scatter_ + clock * clock.transpose();
    const DistanceDistribution distribution(scatter, weights, jacobian_, recordings, rare_);
    fit.chi2 = distribution.distance2(left);
    fit.p_value = distribution.tail(fit.chi2);
  }

  /// The matrix that maps relative deviations to changes of the parameters, for a covariance.
  [[nodiscard]] Matrix weights(const Matrix& covariance) const {
    const Eigen::LLT<Matrix> factor(covariance);
    const Matrix sensitivity = factor.matrixL().solve(jacobian_);
    const Matrix whitening =
        factor.matrixL().solve(Matrix::Identity(covariance.rows(), covariance.cols()));
    return leastSquares(sensitivity, sensitivity.colwise().norm(), whitening);
  }

  /// The covariance of the parameters by cross-validation: the scatter of recordings under weights
  /// from the others. It includes the error of a covariance from few and skew recordings, which
  /// (J^T S^-1 J)^-1 does not.
  [[nodiscard]] Matrix parameterErrors() const {
    constexpr Eigen::Index kFolds = 5;
    const Eigen::Index recordings = deviations_.rows() / 2;
    const auto n = static_cast<double>(recordings);
    const Matrix sum = deviations_.transpose() * deviations_;
    Matrix errors = Matrix::Zero(index(parameters_), index(parameters_));
    for (Eigen::Index fold = 0; fold < kFolds; ++fold) {
      const Eigen::Index first = fold * recordings / kFolds;
      const Eigen::Index count = (fold + 1) * recordings / kFolds - first;
      const Matrix left_out = deviations_.middleRows(2 * first, 2 * count);
      Matrix rest = (sum - left_out.transpose() * left_out) / (n - 1 - static_cast<double>(count));
      rest += systematic_;
      if (regularised_) rest = covariance_;
      const Matrix shifts = left_out * weights(rest).transpose();
      errors += shifts.transpose() * shifts / (n - 1);
    }
    const Matrix all = weights(covariance_);
    const Vector clock = all * clockError();
    return errors + all * systematic_ * all.transpose() + clock * clock.transpose();
  }

  ProgramLaw law_;
  const MeasuredCurves& curves_;
  const FitOptions& options_;
  std::vector<FitParameter> free_;
  std::vector<Column> columns_;
  std::size_t offset_ = 0;  ///< Index of the first tracker offset in theta.
  std::size_t parameters_ = 0;
  bool angular_ = false;
  bool regularised_ = false;
  Vector theta_;  ///< ln(parameter / programmed), then the offsets.
  Vector reference_;
  /// Relative deviations of the recordings, scaled to the measured time. Two rows each, tapered and
  /// not, scaled so that the sum of both covariances is that of the measured time.
  Matrix deviations_;
  Matrix scatter_;     ///< Covariance of the recordings, and of the usual phases of the frames.
  double rare_ = 0;    ///< Share of recordings whose frames keep step with the holds.
  Matrix systematic_;  ///< Covariance that recordings do not show.
  Matrix covariance_;
  Matrix jacobian_;
};

/// A quantity that follows from the parameters of a law.
struct Derived {
  const char* name;
  const char* unit;
  const char* note;
  std::function<double(const ProgramLaw&)> of;
};

std::vector<Derived> derivedOf(const ProgramLaw& law) {
  std::vector<Derived> list;
  if (law->held()) {
    list.push_back({"D_r", "rad^2/s", "of the fitted noise",
                    [](const ProgramLaw& p) { return p->rotationalDiffusivity(); }});
  }
  if (law->drawnWheels()) {
    list.push_back({"D_t", "m^2/s", "of the fitted noise",
                    [](const ProgramLaw& p) { return p->translationalDiffusivity(); }});
  }
  list.push_back({"D", "m^2/s", "long-time limit of the fitted exact law",
                  [](const ProgramLaw& p) { return ExactLaw(p).diffusivity(); }});
  if (law->constantSpeed()) {
    list.push_back({"L_s", "m", "integral of C(l) of the fitted exact law",
                    [](const ProgramLaw& p) { return ExactLaw(p).persistenceLength(); }});
  }
  return list;
}

/// A positive number from the standard error of its logarithm.
Estimate positiveEstimate(const std::string& name, const std::string& unit, double value,
                          double relative, double quantile, double theory, std::string note) {
  const double factor = std::exp(quantile * relative);
  return {name,           unit,   value, value * relative, value / factor,
          value * factor, theory, kNan,  std::move(note)};
}

void Fit::report(LawFit& fit, int recordings) const {
  const Vector left = residuals();
  const double n = recordings - 1;
  const Matrix errors = parameterErrors();
  const double quantile = studentQuantile(n);

  fit.law = law();
  fit.angular = angular_;
  fit.recordings = recordings;
  fit.regularised = regularised_;
  fit.freedom = static_cast<int>(columns() - parameters_);
  setGoodness(fit, recordings);
  const std::string note = angular_ ? "GLS fit of the exact law to MSD and angular MSD"
                                    : "GLS fit of the exact law to the MSD alone: no headings";
  for (std::size_t p = 0; p < free_.size(); ++p) {
    fit.parameters.push_back(positiveEstimate(
        free_[p].label, free_[p].unit, fit.law->parameter(free_[p].name),
        std::sqrt(errors(index(p), index(p))), quantile, law_->parameter(free_[p].name), note));
  }
  for (std::size_t p = offset_; p < parameters_; ++p) {
    const bool angular = p > offset_;
    const double value = theta_(index(p));
    const double sigma = std::sqrt(errors(index(p), index(p)));
    fit.parameters.push_back(
        {angular ? "noise_angular" : "noise_position", angular ? "rad^2" : "m^2", value, sigma,
         value - quantile * sigma, value + quantile * sigma, kNan, kNan,
         angular ? "2 sigma_theta^2 of the tracker, fitted" : "4 sigma^2 of the tracker, fitted"});
  }
  for (Eigen::Index i = 0; i < errors.rows(); ++i) {
    for (Eigen::Index j = 0; j < errors.cols(); ++j) {
      fit.correlation.push_back(errors(i, j) / std::sqrt(errors(i, i) * errors(j, j)));
    }
  }
  for (const Derived& derived : derivedOf(law_)) {
    constexpr double kStep = 1e-3;
    const double value = derived.of(fit.law);
    Vector slope = Vector::Zero(index(parameters_));
    for (std::size_t p = 0; p < offset_; ++p) {
      Vector shifted = theta_;
      shifted(index(p)) += kStep;
      slope(index(p)) = std::log(derived.of(lawAt(shifted)) / value) / kStep;
    }
    fit.derived.push_back(positiveEstimate(derived.name, derived.unit, value,
                                           std::sqrt(slope.dot(errors * slope)), quantile,
                                           derived.of(law_), note + ": " + derived.note));
  }
  // To first order, the ordinary least-squares fit differs by ordinary * residuals.
  const Matrix ordinary = weights(Matrix::Identity(index(columns()), index(columns())));
  const Matrix difference = weights(covariance_) - ordinary;
  const Vector off = ordinary * left;
  const Matrix expected = difference * covariance_ * difference.transpose();
  for (std::size_t p = 0; p < offset_; ++p) {
    // nan if rounding leaves no variance.
    const double z = std::abs(off(index(p))) / std::sqrt(expected(index(p), index(p)));
    fit.guard_z = std::isnan(z) || z > fit.guard_z ? z : fit.guard_z;
  }
}

/// Why there can be no fit; empty: there can.
std::string obstacle(const ProgramLaw& law, const MeasuredCurves& curves, const FitPlan& plan,
                     const FitOptions& options) {
  if (!ExactLaw(law).exists()) return "the program has no law";
  if (!(curves.observed > 0)) return "no free motion was seen";
  if (freeParameters(law, options).empty()) {
    return "the law has no parameters that a fit could free";
  }
  const double draws = curves.observed / law->drawTime();
  if (draws < kFewestDraws) {
    return "about " + std::to_string(std::lround(draws)) + " " + law->drawsName() +
           " are expected in the free motion observed, by the program; a fit needs 100: record for "
           "longer";
  }
  const std::vector<FitParameter> free = freeParameters(law, options);
  for (const FitParameter& parameter : free) {
    if (!(law->parameter(parameter.name) > 0)) {
      return "the programmed " + parameter.label + " is not positive";
    }
  }
  std::size_t seen = 0;
  for (const std::size_t lag : plan.lags) seen += std::isfinite(curves.msd[lag]) ? 1U : 0U;
  if (seen < free.size() + 2) {
    return "only " + std::to_string(seen) + " lags between a frame and " +
           std::to_string(static_cast<int>(std::ceil(law->longestChange()))) +
           " s were observed; a fit needs " + std::to_string(free.size() + 2) +
           ": record longer pieces or at a higher rate";
  }
  const auto last = std::find_if(plan.lags.rbegin(), plan.lags.rend(),
                                 [&](std::size_t lag) { return std::isfinite(curves.msd[lag]); });
  if (!(curves.msd[*last] > 2 * curves.offset)) return "no motion beyond the tracker's noise";
  return {};
}

}  // namespace

LawFit fitLaw(const ProgramLaw& law, const MeasuredCurves& curves, const FitOptions& options,
              const SimulatedCurves* given, SimulatedCurves* used) {
  LawFit result;
  result.law = law;
  result.p_value = kNan;
  const FitPlan plan = planFit(law, curves, options);
  result.refusal = obstacle(law, curves, plan, options);
  if (!result.fitted()) return result;
  for (const std::size_t lag : plan.lags) result.lags.push_back(curves.lags[lag]);
  Fit fit(law, curves, plan, options);
  if (given != nullptr && given->lags.size() != plan.lags.size()) {
    result.refusal = "too short a track for the lags of its program's other robots";
    return result;
  }
  const char* failed =
      "the curves are not like the program's: no parameters within a factor of 5 "
      "of the programmed ones describe them";
  SimulatedCurves recordings;
  if (given == nullptr) {
    for (int round = 0; round < 3; ++round) {
      if (!fit.solve()) {
        result.refusal = failed;
        return result;
      }
      if (round == 2) break;
      recordings =
          simulateForFit(fit.law(), fit.offset(), fit.angularOffset(), curves, plan, options);
      if (recordings.recordings < kRecordingsPerColumn * static_cast<int>(fit.columns())) {
        result.refusal =
            "too few of the segments are as long as the lags: avoid contacts, or record longer";
        return result;
      }
      fit.setCovariance(recordings);
    }
    given = &recordings;
  } else {
    fit.setCovariance(*given);
    if (!fit.solve()) {
      result.refusal = failed;
      return result;
    }
  }
  fit.report(result, given->recordings);
  result.recording_duration = given->duration;
  if (used != nullptr && given == &recordings) *used = std::move(recordings);
  return result;
}

}  // namespace lab::analysis
