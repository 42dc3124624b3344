#include "analyzer/curve_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lab::analysis {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kDenseLags = 16;  // frames; as in MsdAccumulator
constexpr int kWindowsPerLag = 11;

double columnError(const SimulatedCurves& curves, std::size_t column) {
  double sum = 0;
  double sum2 = 0;
  for (int film = 0; film < curves.films; ++film) {
    const double deviation = curves.value(film, column) / curves.law[column] - 1;
    sum += deviation;
    sum2 += deviation * deviation;
  }
  const double n = curves.films;
  return std::sqrt((sum2 - sum * sum / n) / (n - 1));
}

}  // namespace

std::vector<double> filmCurves(const FilmPoses& poses, const std::vector<int>& lags) {
  const std::size_t n = lags.size();
  const std::size_t frames = poses.x.size();
  std::vector<double> curves(2 * n, kNan);
  for (std::size_t i = 0; i < n; ++i) {
    const auto lag = static_cast<std::size_t>(lags[i]);
    const std::size_t stride = lags[i] < kDenseLags ? 1 : lag / kWindowsPerLag;
    double r2 = 0;
    double a2 = 0;
    std::size_t windows = 0;
    for (std::size_t end = lag; end < frames; end += stride) {
      const std::size_t start = end - lag;
      const double dx = poses.x[end] - poses.x[start];
      const double dy = poses.y[end] - poses.y[start];
      const double turn = poses.theta[end] - poses.theta[start];
      r2 += dx * dx + dy * dy;
      a2 += turn * turn;
      ++windows;
    }
    if (windows > 0) {
      curves[i] = r2 / static_cast<double>(windows);
      curves[n + i] = a2 / static_cast<double>(windows);
    }
  }
  return curves;
}

SimulatedCurves simulateCurves(const BootstrapPlan& plan) {
  SimulatedCurves result;
  result.duration = plan.duration;
  result.films = plan.films;
  std::vector<int> frames;
  for (const double lag : plan.lags) {
    frames.push_back(std::max(1, static_cast<int>(std::lround(lag / plan.period))));
    result.lags.push_back(frames.back() * plan.period);
  }
  const ExactLaw exact(plan.law);
  for (const double lag : result.lags) {
    result.law.push_back(exact.msd(lag) + 4 * plan.sigma * plan.sigma);
  }
  for (const double lag : result.lags) {
    result.law.push_back(exact.angularMsd(lag) + 2 * plan.sigma_theta * plan.sigma_theta);
  }
  const FilmPlan film{plan.law, plan.duration, plan.period, plan.sigma, plan.sigma_theta, 0};
  FilmPoses poses;
  for (int i = 0; i < plan.films; ++i) {
    simulateFilm(film, plan.seed + static_cast<std::uint64_t>(i), poses);
    const std::vector<double> curves = filmCurves(poses, frames);
    result.values.insert(result.values.end(), curves.begin(), curves.end());
  }
  return result;
}

double errorScale(double simulated, double observed, double segments, double tau) {
  // A share of the film at the least, so that lags near a whole segment keep a finite error: half
  // of one segment; of many, some of which are longer than the mean, less.
  const double least = (segments > 1 ? 0.1 : 0.5) * observed;
  const double covered = std::max(observed - segments * tau, least);
  return std::sqrt(std::max(simulated - tau, 0.5 * simulated) / covered);
}

double relativeError(const SimulatedCurves& curves, bool angular, double tau, double observed,
                     double segments) {
  const std::size_t n = curves.lags.size();
  if (n < 2 || tau < curves.lags.front() || tau > curves.lags.back()) return kNan;
  const auto above = std::upper_bound(curves.lags.begin(), curves.lags.end() - 1, tau);
  const auto high = static_cast<std::size_t>(above - curves.lags.begin());
  const std::size_t low = high - 1;
  const double share =
      std::log(tau / curves.lags[low]) / std::log(curves.lags[high] / curves.lags[low]);
  const std::size_t column = angular ? n : 0;
  const double error = std::exp((1 - share) * std::log(columnError(curves, column + low)) +
                                share * std::log(columnError(curves, column + high)));
  return error * errorScale(curves.duration, observed, segments, tau);
}

}  // namespace lab::analysis
