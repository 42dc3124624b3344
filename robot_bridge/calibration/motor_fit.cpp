#include "robot_bridge/calibration/motor_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "light/median.hpp"
#include "light/optics/levenberg_marquardt.hpp"
#include "robot_bridge/calibration/track_noise.hpp"

namespace lab::calibration {
namespace {

enum Parameter { kGainLeft, kGainRight, kBandLeft, kBandRight, kBase, kLateral, kParameters };
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using Information = Eigen::Matrix<double, kParameters, kParameters>;
using Slopes = Eigen::Matrix<double, 2, kParameters>;

constexpr int kEvaluations = 60;
constexpr double kConverged = 1e-12;       // relative reduction of chi^2
constexpr double kSingular = 1e-9;         // smallest scaled eigenvalue of the information
constexpr double kOutlierChi2 = 30;        // two degrees of freedom: probability 1 in 3 million
constexpr double kMuchMoreThanNoise = 4;   // chi^2 per degree of freedom
constexpr double kMedianOfTwoDof = 1.386;  // median of chi^2 with two degrees of freedom

Parameters parametersOf(const Motors& motors, double lateral) {
  Parameters p;
  p << motors.left.gain, motors.right.gain, motors.left.dead_band, motors.right.dead_band,
      motors.wheel_base, lateral;
  return p;
}

Motors motorsOf(const Parameters& p) {
  return {{p[kGainLeft], p[kBandLeft]}, {p[kGainRight], p[kBandRight]}, p[kBase]};
}

/// Speed and turning rate of the tracked point, and their derivatives.
struct Prediction {
  Eigen::Vector2d value;
  Slopes slopes = Slopes::Zero();
};

Prediction predict(const Parameters& p, const UsableSegment& segment, double max) {
  const Motors motors = motorsOf(p);
  const double left = wheelSpeed(motors.left, segment.duty_left, max);
  const double right = wheelSpeed(motors.right, segment.duty_right, max);
  const double turn = (right - left) / motors.wheel_base;
  Prediction prediction;
  prediction.value << (left + right) / 2 - p[kLateral] * turn, turn;

  // d speed / d gain = speed / gain; d speed / d band = -max gain (1 - |u|) / (1 - band)^2
  const auto by_band = [max](const Wheel& wheel, double duty, double speed) {
    if (speed == 0) return 0.0;
    const double rest = 1 - wheel.dead_band;
    return std::copysign(max * wheel.gain * (1 - std::fabs(duty)) / (rest * rest), -duty);
  };
  const Eigen::Vector2d of_left(0.5 + p[kLateral] / motors.wheel_base, -1 / motors.wheel_base);
  const Eigen::Vector2d of_right(0.5 - p[kLateral] / motors.wheel_base, 1 / motors.wheel_base);
  prediction.slopes.col(kGainLeft) = of_left * (left / motors.left.gain);
  prediction.slopes.col(kGainRight) = of_right * (right / motors.right.gain);
  prediction.slopes.col(kBandLeft) = of_left * by_band(motors.left, segment.duty_left, left);
  prediction.slopes.col(kBandRight) = of_right * by_band(motors.right, segment.duty_right, right);
  prediction.slopes.col(kBase) << p[kLateral] * turn / motors.wheel_base, -turn / motors.wheel_base;
  prediction.slopes(0, kLateral) = -turn;
  return prediction;
}

struct Solution {
  Parameters p;
  Information covariance = Information::Zero();
  double chi2 = 0;
  bool determined = false;
};

double chi2Of(const Parameters& p, const UsableSegment& segment, double max) {
  const Eigen::Vector2d residual = segment.motion.value - predict(p, segment, max).value;
  return residual.dot(segment.motion.covariance.ldlt().solve(residual));
}

/// The parameters that the fit may change.
using Free = std::vector<int>;
const Free kAll = {kGainLeft, kGainRight, kBandLeft, kBandRight, kBase, kLateral};
const Free kBandsHeld = {kGainLeft, kGainRight, kBase, kLateral};

bool isFeasible(const Parameters& p) {
  return p.allFinite() && p[kGainLeft] > 0 && p[kGainRight] > 0 && p[kBase] > 0 &&
         p[kBandLeft] < 1 && p[kBandRight] < 1;
}

Solution solve(const std::vector<UsableSegment>& segments, const Parameters& start, double max,
               const Free& free) {
  // Residuals are whitened: with covariance = L L^T, L^-1 residual has unit covariance.
  std::vector<Eigen::Matrix2d> whitening;
  for (const UsableSegment& segment : segments) {
    const Eigen::Matrix2d lower = segment.motion.covariance.llt().matrixL();
    whitening.push_back(lower.inverse());
  }
  const auto parametersAt = [&](const Eigen::VectorXd& x) {
    Parameters p = start;
    for (std::size_t i = 0; i < free.size(); ++i) p[free[i]] = x[static_cast<Eigen::Index>(i)];
    return p;
  };
  optics::LeastSquaresProblem problem;
  problem.residuals = 2 * static_cast<int>(segments.size());
  problem.tolerance = kConverged;
  problem.evaluations = kEvaluations;
  problem.residuals_at = [&](const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> out) {
    const Parameters p = parametersAt(x);
    if (!isFeasible(p)) {
      out.setConstant(std::numeric_limits<double>::infinity());
      return;
    }
    for (std::size_t i = 0; i < segments.size(); ++i) {
      out.segment<2>(2 * static_cast<Eigen::Index>(i)) =
          whitening[i] * (predict(p, segments[i], max).value - segments[i].motion.value);
    }
  };
  problem.jacobian_at = [&](const Eigen::VectorXd& x, Eigen::Ref<Eigen::MatrixXd> out) {
    const Parameters p = parametersAt(x);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const Slopes slopes = whitening[i] * predict(p, segments[i], max).slopes;
      for (std::size_t j = 0; j < free.size(); ++j) {
        out.block<2, 1>(2 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            slopes.col(free[j]);
      }
    }
  };
  Eigen::VectorXd x(static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) x[static_cast<Eigen::Index>(i)] = start[free[i]];
  x = optics::solveLeastSquares(problem, x);

  Solution solution;
  solution.p = parametersAt(x);
  for (const UsableSegment& segment : segments) {
    solution.chi2 += chi2Of(solution.p, segment, max);
  }
  if (!isFeasible(solution.p)) return solution;
  Eigen::MatrixXd jacobian(problem.residuals, x.size());
  problem.jacobian_at(x, jacobian);
  if (const auto covariance = optics::covarianceOf(jacobian.transpose() * jacobian, kSingular)) {
    solution.determined = true;
    for (std::size_t i = 0; i < free.size(); ++i) {
      for (std::size_t j = 0; j < free.size(); ++j) {
        solution.covariance(free[i], free[j]) =
            (*covariance)(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }
  return solution;
}

/// Fits repeatedly and excludes the worst outlier each time.
Solution solveRobustly(std::vector<UsableSegment>& segments, const Parameters& start, double max,
                       SegmentCounts& counts) {
  for (;;) {
    const Solution solution = solve(segments, start, max, kAll);
    if (!solution.determined) return solution;
    std::vector<double> chi2;
    for (const UsableSegment& segment : segments) chi2.push_back(chi2Of(solution.p, segment, max));
    const auto worst = std::max_element(chi2.begin(), chi2.end());
    const auto index = worst - chi2.begin();
    const double worst_chi2 = *worst;
    // Deviations of the motors from the model increase the residuals of all segments; scaling by
    // the median avoids that these are taken for outliers.
    const double scale = std::max(1.0, medianOf(chi2) / kMedianOfTwoDof);
    const bool too_few = 2 * static_cast<int>(segments.size()) <= kParameters + 2;
    if (worst_chi2 <= kOutlierChi2 * scale || too_few) return solution;
    segments.erase(segments.begin() + index);
    ++counts.outlying;
    --counts.used;
  }
}

double residualShare(const Parameters& p, const std::vector<UsableSegment>& segments, double max) {
  double missed = 0;
  double moved = 0;
  for (const UsableSegment& segment : segments) {
    const Eigen::Vector2d predicted = predict(p, segment, max).value;
    const Eigen::Vector2d to_wheels(1, p[kBase] / 2);
    missed += (segment.motion.value - predicted).cwiseProduct(to_wheels).squaredNorm();
    moved += predicted.cwiseProduct(to_wheels).squaredNorm();
  }
  return moved > 0 ? std::sqrt(missed / moved) : 0;
}

std::string wheelRefusal(const char* side, const Wheel& wheel, const Wheel& error,
                         const FitLimits& limits) {
  if (wheel.gain < 0.5 || wheel.gain > 1.5) {
    return fmt::format(
        "gain of the {} wheel: found {:.3f}, allowed 0.5 to 1.5; is max_wheel_speed_cm_s right?",
        side, wheel.gain);
  }
  if (wheel.dead_band > 0.45 || wheel.dead_band < -0.1) {
    return fmt::format("dead band of the {} wheel: found {:.1f} % of full duty, allowed 0 to 45",
                       side, 100 * wheel.dead_band);
  }
  if (error.gain > limits.gain_error || error.dead_band > limits.dead_band_error) {
    return fmt::format(
        "the {} wheel is not known well enough: gain to {:.2f} %, dead band to {:.2f} % of full "
        "duty, allowed {:g} and {:g}; a camera with more frames or less noise helps",
        side, 100 * error.gain, 100 * error.dead_band, 100 * limits.gain_error,
        100 * limits.dead_band_error);
  }
  return "";
}

std::string fewSegments(const SegmentCounts& counts, int needed) {
  return fmt::format(
      "{} of {} parts of the pattern are usable, {} are needed ({} not seen by the tracker, {} not "
      "even, {} unlike the others): give the robot room and see that the camera sees it",
      counts.used, counts.driven, needed, counts.unseen, counts.uneven, counts.outlying);
}

std::string refusalOf(const MotorFit& fit, double nominal_base, const FitLimits& limits) {
  const Motors& motors = fit.motors;
  // With a coarse tracker, a large residual may only be noise.
  if (fit.residual > limits.residual && fit.chi2_per_dof > kMuchMoreThanNoise) {
    return fmt::format(
        "the wheel speeds differ from the fitted ones by {:.1f} % (rms), allowed {:g}: do the "
        "wheels slip, or does something block them?",
        100 * fit.residual, 100 * limits.residual);
  }
  if (std::string text = wheelRefusal("left", motors.left, fit.error.left, limits); !text.empty())
    return text;
  if (std::string text = wheelRefusal("right", motors.right, fit.error.right, limits);
      !text.empty())
    return text;
  if (std::fabs(motors.wheel_base / nominal_base - 1) > 0.5) {
    return fmt::format(
        "wheel base: found {:.2f} cm, allowed {:.2f} to {:.2f}; is diameter_cm right?",
        100 * motors.wheel_base, 50 * nominal_base, 150 * nominal_base);
  }
  if (fit.error.wheel_base > limits.base_error * motors.wheel_base) {
    return fmt::format("the wheel base is known to {:.1f} %, allowed {:g}",
                       100 * fit.error.wheel_base / motors.wheel_base, 100 * limits.base_error);
  }
  return "";
}

}  // namespace

MotorFit fitMotors(const std::vector<Segment>& segments, const Motors& nominal, double max,
                   const FitLimits& limits) {
  UsableSegments usable = usableSegments(segments);
  MotorFit fit;
  fit.motors = nominal;
  fit.noise = usable.noise;
  fit.segments = usable.counts;
  const int needed =
      static_cast<int>(std::ceil(limits.used_share * static_cast<double>(segments.size())));
  if (fit.segments.used < needed || fit.segments.used < kParameters) {
    fit.refusal = fewSegments(fit.segments, needed);
    return fit;
  }
  const Solution solution =
      solveRobustly(usable.segments, parametersOf(nominal, 0), max, fit.segments);
  if (!solution.determined) {
    fit.refusal = "the robot did not move enough to tell its wheels apart: does it drive at all?";
    return fit;
  }
  const double dof = 2.0 * fit.segments.used - static_cast<double>(kParameters);
  fit.chi2_per_dof = solution.chi2 / dof;
  const double widen = std::sqrt(std::max(1.0, fit.chi2_per_dof));
  const Parameters error = widen * solution.covariance.diagonal().cwiseSqrt();
  fit.motors = motorsOf(solution.p);
  fit.error = motorsOf(error);
  fit.lateral = solution.p[kLateral];
  fit.lateral_error = error[kLateral];
  fit.residual = residualShare(solution.p, usable.segments, max);
  fit.refusal = fit.segments.used < needed ? fewSegments(fit.segments, needed)
                                           : refusalOf(fit, nominal.wheel_base, limits);
  return fit;
}

Motors fitStorable(const MotorFit& fit, const std::vector<Segment>& segments, double max) {
  UsableSegments usable = usableSegments(segments);
  std::erase_if(usable.segments, [&](const UsableSegment& segment) {
    const double scale = std::max(1.0, fit.chi2_per_dof);
    return chi2Of(parametersOf(fit.motors, fit.lateral), segment, max) > kOutlierChi2 * scale;
  });
  const Parameters start = parametersOf(storable(fit.motors), fit.lateral);
  return storable(motorsOf(solve(usable.segments, start, max, kBandsHeld).p));
}

}  // namespace lab::calibration
