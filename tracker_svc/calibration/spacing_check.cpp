#include "tracker_svc/calibration/spacing_check.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lab::calibration {
namespace {

constexpr double kPlace = 0.10;   // [m] width of a cell
constexpr double kMargin = 0.10;  // [m] around the arena that still has cells
constexpr double kWeakest = 0.3;  // [1, 1/m] prior standard deviation
constexpr double kChi2 = 25;      // with 3 degrees of freedom: probability 1.5e-5
constexpr double kMisfitChi2 = 25;
constexpr int kNeeded = 2;            // consecutive windows
constexpr int kLearning = 4;          // windows accepted without a test
constexpr double kTiltToSlope = 1.5;  // mean over headings: 2 along the tilt and 1 across it

double squared(double value) { return value * value; }

/// Limit on chi^2 when the scatter is estimated with `dof` degrees of freedom: the quantile of the
/// F distribution with the same tail as chi^2 at kChi2.
double limitFor(double dof) { return dof * std::expm1(kChi2 / dof); }

}  // namespace

SpacingCheck::Vector SpacingCheck::Fit::value() const { return covariance() * gradient; }

SpacingCheck::Matrix SpacingCheck::Fit::covariance() const {
  const Matrix weak = Matrix::Identity() / squared(kWeakest);
  return (information + weak).inverse();
}

SpacingCheck::SpacingCheck(const SpacingSettings& settings) : settings_(settings) {
  const auto across = [](double length) {
    return std::max(1, static_cast<int>(std::ceil((length + 2 * kMargin) / kPlace - 1e-9)));
  };
  columns_ = across(settings_.arena_width);
  rows_ = across(settings_.arena_height);
  places_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {});
}

void SpacingCheck::add(double time, double x, double y, double spacing, double sigma) {
  if (!std::isfinite(time) || !std::isfinite(x + y + spacing) || !(sigma > 0)) return;
  if (!std::isfinite(sigma) || !(spacing > 0)) return;
  closeWindows(time);
  if (!window_begin_) window_begin_ = time;
  const auto place = [](double at, int count) {
    return std::clamp(static_cast<int>(std::floor((at + kMargin) / kPlace)), 0, count - 1);
  };
  Place& here = places_[static_cast<std::size_t>(place(y, rows_) * columns_ + place(x, columns_))];
  const double weight = squared(settings_.spacing / sigma);
  here.weight += weight;
  here.error += weight * (spacing / settings_.spacing - 1);
  here.x += weight * (x - settings_.arena_width / 2);
  here.y += weight * (y - settings_.arena_height / 2);
}

double SpacingCheck::varianceOf(const Place& place) const {
  return 1 / place.weight + squared(settings_.place_error / settings_.spacing);
}

SpacingCheck::Fit SpacingCheck::fitOf(const std::vector<Place>& places, Place& middle) const {
  Fit fit;
  for (const Place& place : places) {
    if (place.weight <= 0) continue;
    const double variance = varianceOf(place);
    const Vector slopes = place.slopes();
    const double error = place.error / place.weight;
    fit.information += slopes * slopes.transpose() / variance;
    fit.gradient += slopes * error / variance;
    middle.weight += 1 / variance;
    middle.error += error / variance;
  }
  return fit;
}

double SpacingCheck::widening() const {
  if (first_.size() < 2) return 1;
  const Vector mean = baseline_.value();
  double chi2 = 0;
  for (const Fit& fit : first_) {
    const Vector deviation = fit.value() - mean;
    chi2 += deviation.dot(fit.information * deviation);
  }
  return std::max(1.0, chi2 / (3 * (static_cast<double>(first_.size()) - 1)));
}

/// The rms displacement of positions is the root of the weighted sum of squares of scale and slopes
/// [m^2].
SpacingCheck::Vector SpacingCheck::shiftWeights() const {
  // Relative to the middle: a scale error displaces in proportion to the distance from it; rms over
  // a rectangle.
  const double radius2 = (squared(settings_.arena_width) + squared(settings_.arena_height)) / 12;
  const double of_tilt = squared(squared(settings_.camera_height) / kTiltToSlope);
  return {radius2, of_tilt, of_tilt};
}

double SpacingCheck::shiftOf(const Vector& change, const Matrix& covariance) const {
  const Vector weights = shiftWeights();
  const double seen = weights.dot(change.cwiseAbs2());
  return std::sqrt(std::max(0.0, seen - weights.dot(covariance.diagonal())));
}

void SpacingCheck::closeWindows(double time) {
  if (!window_begin_ || time - *window_begin_ < settings_.window) return;
  Place middle;
  const Fit fit = fitOf(places_, middle);
  std::ranges::fill(places_, Place{});
  window_begin_.reset();  // the next window begins with the next cap
  if (middle.weight <= 0) return;
  last_.known = true;
  last_.scale = middle.error / middle.weight;
  last_.mean_error = last_.scale * settings_.spacing;
  last_.sigma = settings_.spacing * std::sqrt(widening() / middle.weight);
  evaluate(fit);
}

/// Deviation from the calibration, tested with the errors of the caps and of the calibration added.
bool SpacingCheck::misfits(const Vector& value, const Matrix& covariance,
                           SpacingReport& report) const {
  report.slope_x = value[1];
  report.slope_y = value[2];
  Matrix allowed = covariance;
  allowed(0, 0) += squared(settings_.common_error);
  allowed(1, 1) += squared(settings_.uneven_error);
  allowed(2, 2) += squared(settings_.uneven_error);
  report.position_error = shiftOf(value, covariance);
  report.position_sigma = std::sqrt(shiftWeights().dot(covariance.diagonal()));
  return value.dot(allowed.inverse() * value) > kMisfitChi2 &&
         report.position_error > settings_.most_shift;
}

SpacingReport SpacingCheck::whole() const {
  SpacingReport report;
  Place middle;
  const Fit fit = fitOf(places_, middle);
  const Vector value = fit.value();
  double chi2 = 0;
  double dof = -3;
  for (const Place& place : places_) {
    if (place.weight <= 0) continue;
    const double residual = place.error / place.weight - place.slopes().dot(value);
    chi2 += squared(residual) / varianceOf(place);
    dof += 1;
  }
  if (dof < 1) return report;
  // A scatter estimated from few cells may be far too small.
  const double wider = std::max(1.0, chi2 / dof) * limitFor(dof) / kChi2;
  report.known = true;
  report.scale = middle.error / middle.weight;
  report.mean_error = report.scale * settings_.spacing;
  report.sigma = settings_.spacing * std::sqrt(wider / middle.weight);
  report.fits = !misfits(value, fit.covariance() * wider, report);
  describe(report);
  return report;
}

void SpacingCheck::evaluate(const Fit& window) {
  const Vector value = window.value();
  const Matrix covariance = window.covariance() * widening();
  misfits_ = misfits(value, covariance, last_) ? misfits_ + 1 : 0;
  last_.fits = misfits_ < kNeeded;

  bool differs = false;
  const bool learning = first_.size() < kLearning;
  if (!learning) {
    const Vector change = value - baseline_.value();
    const Matrix both = covariance + baseline_.covariance() * widening();
    last_.shift = shiftOf(change, both);
    last_.chi2 = change.dot(both.inverse() * change);
    const double dof = 3 * (static_cast<double>(first_.size()) - 1);
    differs = last_.chi2 > limitFor(dof) && last_.shift > settings_.least_shift;
  }
  beyond_ = differs ? beyond_ + 1 : 0;
  last_.moved = beyond_ >= kNeeded;
  if (differs || (!learning && covered_ >= settings_.baseline)) return;
  first_.push_back(window);
  baseline_.information += window.information;
  baseline_.gradient += window.gradient;
  covered_ += settings_.window;
}

void SpacingCheck::describe(SpacingReport& report) const {
  if (report.moved) {
    report.text = fmt::format(
        "the camera has moved since the start: positions are off by about {:.1f} mm (rms) from "
        "then, scale {:+.2f} %, slope {:+.2f} and {:+.2f} %/m: calibrate it again "
        "(lab calibrate camera)",
        1e3 * report.shift, 100 * report.scale, 100 * report.slope_x, 100 * report.slope_y);
  } else if (!report.fits) {
    report.text = fmt::format(
        "the calibration does not fit: circles are {:.2f} mm apart, known {:.2f}, and that changes "
        "by {:+.2f} and {:+.2f} %/m along x and y: positions are off by about {:.1f} mm (rms): was "
        "the camera moved, tilted or zoomed, are R or cx and cy wrong, or the caps others? "
        "calibrate it again (lab calibrate camera)",
        1e3 * (settings_.spacing + report.mean_error), 1e3 * settings_.spacing,
        100 * report.slope_x, 100 * report.slope_y, 1e3 * report.position_error);
  }
}

SpacingReport SpacingCheck::report(double time) {
  closeWindows(time);
  SpacingReport report = last_;
  if (!report.known) {  // the first window is not complete yet
    Place middle;
    static_cast<void>(fitOf(places_, middle));
    if (middle.weight > 0) {
      report.scale = middle.error / middle.weight;
      report.mean_error = report.scale * settings_.spacing;
      report.sigma = settings_.spacing / std::sqrt(middle.weight);
    }
  }
  describe(report);
  return report;
}

}  // namespace lab::calibration
