#include "light/photometry/light_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>

#include "light/optics/levenberg_marquardt.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::calibration {
namespace {

// Unknowns: log scale, log gamma, ambient, v0 .. v4, then the log gain of every sensor but the
// last, whose gain follows from the mean log gain of 0.
constexpr int kScale = 0;
constexpr int kGamma = 1;
constexpr int kAmbient = 2;
constexpr int kVignetting = 3;
constexpr int kGains = 8;

constexpr double kFull = 0.999;  // readings above this may be saturated
constexpr double kGrid = 0.10;   // [m] side of the cells that count as one place

struct Problem {
  std::vector<LightSample> samples;
  std::map<SensorName, int> sensors;  ///< index of each sensor
  double width = 1;
  double height = 1;

  [[nodiscard]] int unknowns() const { return kGains + static_cast<int>(sensors.size()) - 1; }
};

double gainOf(const Eigen::VectorXd& at, int sensor, int count) {
  if (sensor + 1 < count) return at[kGains + sensor];
  return -at.tail(count - 1).sum();
}

/// Residual in units of its standard error, and its derivatives.
double residualOf(const Problem& problem, const LightSample& sample, const Eigen::VectorXd& at,
                  Eigen::VectorXd* slope) {
  const int count = static_cast<int>(problem.sensors.size());
  const int sensor = problem.sensors.at(sample.sensor);
  const double a = 2 * sample.place.x / problem.width - 1;
  const double b = 2 * sample.place.y / problem.height - 1;
  const double shape[5] = {a, b, a * a, a * b, b * b};
  double white = 1;
  for (int i = 0; i < 5; ++i) white += at[kVignetting + i] * shape[i];
  const double gamma = std::exp(at[kGamma]);
  const double tone = sample.value > 0 ? std::pow(sample.value, gamma) : 0;
  const double scale = std::exp(at[kScale]);
  const double gain = std::exp(gainOf(at, sensor, count));
  const double lit = gain * scale * white * tone;
  const double sigma = std::max(sample.sigma, kLeastSigma);
  const double reading = lit + gain * at[kAmbient];
  if (slope != nullptr) {
    slope->setZero(problem.unknowns());
    (*slope)[kScale] = lit;
    (*slope)[kGamma] = sample.value > 0 ? lit * gamma * std::log(sample.value) : 0;
    (*slope)[kAmbient] = gain;
    for (int i = 0; i < 5; ++i) (*slope)[kVignetting + i] = gain * scale * tone * shape[i];
    if (sensor + 1 < count) {
      (*slope)[kGains + sensor] = reading;
    } else {
      slope->tail(count - 1).setConstant(-reading);
    }
    *slope /= sigma;
  }
  return (reading - sample.reading) / sigma;
}

double costOf(const Problem& problem, const Eigen::VectorXd& at) {
  double cost = 0;
  for (const LightSample& sample : problem.samples) {
    const double residual = residualOf(problem, sample, at, nullptr);
    cost += residual * residual;
  }
  return cost;
}

Eigen::MatrixXd informationAt(const Problem& problem, const Eigen::VectorXd& at) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(problem.unknowns(), problem.unknowns());
  Eigen::VectorXd slope;
  for (const LightSample& sample : problem.samples) {
    residualOf(problem, sample, at, &slope);
    information += slope * slope.transpose();
  }
  return information;
}

Eigen::VectorXd solve(const Problem& problem, const Eigen::VectorXd& start) {
  optics::LeastSquaresProblem least_squares;
  least_squares.residuals = static_cast<int>(problem.samples.size());
  least_squares.residuals_at = [&](const Eigen::VectorXd& at, Eigen::Ref<Eigen::VectorXd> out) {
    Eigen::Index row = 0;
    for (const LightSample& sample : problem.samples) {
      out[row++] = residualOf(problem, sample, at, nullptr);
    }
  };
  least_squares.jacobian_at = [&](const Eigen::VectorXd& at, Eigen::Ref<Eigen::MatrixXd> out) {
    Eigen::VectorXd slope;
    Eigen::Index row = 0;
    for (const LightSample& sample : problem.samples) {
      residualOf(problem, sample, at, &slope);
      out.row(row++) = slope;
    }
  };
  return optics::solveLeastSquares(least_squares, start);
}

Eigen::VectorXd startOf(const Problem& problem) {
  double brightest = 0.01;
  double darkest = 1;
  for (const LightSample& sample : problem.samples) {
    brightest = std::max(brightest, sample.reading / std::max(sample.value, 0.1));
    darkest = std::min(darkest, sample.reading);
  }
  Eigen::VectorXd at = Eigen::VectorXd::Zero(problem.unknowns());
  at[kScale] = std::log(brightest);
  at[kGamma] = std::log(1.5);
  at[kAmbient] = std::max(0.0, darkest);
  return at;
}

std::string tooLittle(const Problem& problem, const LightLimits& limits) {
  std::set<int> levels;
  std::set<std::pair<int, int>> places;
  for (const LightSample& sample : problem.samples) {
    levels.insert(static_cast<int>(std::lround(sample.value * 1000)));
    places.insert({static_cast<int>(std::floor(sample.place.x / kGrid)),
                   static_cast<int>(std::floor(sample.place.y / kGrid))});
  }
  if (static_cast<int>(levels.size()) < limits.levels) {
    return fmt::format("readings at {} different lights, needed at least {}", levels.size(),
                       limits.levels);
  }
  if (static_cast<int>(places.size()) < limits.places) {
    return fmt::format(
        "readings at {} places (squares of 10 cm), needed at least {}: more robots, or let them "
        "drive to more places",
        places.size(), limits.places);
  }
  return {};
}

}  // namespace

double LightFit::reading(const SensorName& sensor, optics::Place place, double value, double width,
                         double height) const {
  const optics::ProjectorTone tone(gamma, vignetting, width, height);
  const double gain = gains.contains(sensor) ? gains.at(sensor) : 1;
  return gain * (ambient + scale * tone.light(value, place));
}

LightFit fitLight(const std::vector<LightSample>& samples, double width, double height,
                  const LightLimits& limits) {
  LightFit fit;
  Problem problem;
  problem.width = width;
  problem.height = height;
  for (const LightSample& sample : samples) {
    if (sample.reading >= kFull) {
      ++fit.saturated;
      continue;
    }
    problem.samples.push_back(sample);
    problem.sensors.try_emplace(sample.sensor, static_cast<int>(problem.sensors.size()));
  }
  fit.samples = static_cast<int>(problem.samples.size());
  fit.refusal = tooLittle(problem, limits);
  if (!fit.refusal.empty() || fit.samples <= problem.unknowns()) {
    if (fit.refusal.empty()) fit.refusal = "fewer readings than unknowns";
    return fit;
  }
  const Eigen::VectorXd at = solve(problem, startOf(problem));
  fit.scale = std::exp(at[kScale]);
  fit.gamma = std::exp(at[kGamma]);
  fit.ambient = at[kAmbient];
  std::copy_n(at.data() + kVignetting, 5, fit.vignetting.begin());
  const int count = static_cast<int>(problem.sensors.size());
  for (const auto& [name, number] : problem.sensors) {
    fit.gains[name] = std::exp(gainOf(at, number, count));
  }
  double sum = 0;
  for (const LightSample& sample : problem.samples) {
    const double off =
        std::abs(residualOf(problem, sample, at, nullptr)) * std::max(sample.sigma, kLeastSigma);
    sum += off * off;
    fit.worst = std::max(fit.worst, off);
  }
  fit.residual = std::sqrt(sum / fit.samples);
  const Eigen::MatrixXd information = informationAt(problem, at);
  // If the model's misfit exceeds the noise of the readings, it widens all errors.
  const double spread = std::max(1.0, costOf(problem, at) / (fit.samples - problem.unknowns()));
  const Eigen::MatrixXd covariance =
      information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  fit.gamma_sigma = fit.gamma * std::sqrt(spread * std::max(0.0, covariance(kGamma, kGamma)));
  for (const auto& [name, gain] : fit.gains) {
    if (gain <= limits.gain && gain >= 1 / limits.gain) continue;
    fit.refusal = fmt::format(
        "the {} sensor of robot {} reads {:.3g} times what the others read, allowed {:.2g} to "
        "{:.2g}: "
        "is it covered, or broken?",
        name.front ? "front" : "back", name.robot, gain, 1 / limits.gain, limits.gain);
    return fit;
  }
  if (!(fit.gamma <= limits.gamma && fit.gamma >= 1 / limits.gamma)) {
    fit.refusal =
        fmt::format("gamma {:.3g}, allowed {:.2g} to {:.2g}: did the light change at all?",
                    fit.gamma, 1 / limits.gamma, limits.gamma);
    return fit;
  }
  if (!(fit.residual <= limits.residual)) {
    fit.refusal = fmt::format(
        "readings differ from the model by {:.2f} % of full scale, allowed {:.2f} %: is there "
        "other "
        "light, "
        "does something shade the robots, is the geometric calibration in force?",
        100 * fit.residual, 100 * limits.residual);
  }
  return fit;
}

}  // namespace lab::calibration
