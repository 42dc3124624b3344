#include "analyzer/bootstrap/curve_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analyzer/curves/window_choice.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

double columnError(const SimulatedCurves& curves, std::size_t column) {
  double sum = 0;
  double sum2 = 0;
  for (int recording = 0; recording < curves.recordings; ++recording) {
    const double deviation = curves.value(recording, column) / curves.law[column] - 1;
    sum += deviation;
    sum2 += deviation * deviation;
  }
  const double n = curves.recordings;
  return std::sqrt((sum2 - sum * sum / n) / (n - 1));
}

constexpr double kRamp = 1.0 / 3;  // of a recording, at both ends

/// Tukey's taper (1967): 0 at the ends of a recording, 1 in its middle.
/// @param place in the recording, 0 to 1
double taper(double place) {
  const double ramp = std::min(1.0, std::min(place, 1 - place) / kRamp);
  const double root = std::sin(0.5 * std::numbers::pi * ramp);
  return root * root;
}

struct TaperedSum {
  double weight = 0;
  double sum = 0;

  void add(double of, double value) {
    weight += of;
    sum += of * value;
  }
  [[nodiscard]] double mean() const { return weight > 0 ? sum / weight : kNan; }
};

bool joined(const std::vector<int>& stretches, std::size_t start, std::size_t end) {
  return stretches.empty() || (stretches[start] >= 0 && stretches[start] == stretches[end]);
}

}  // namespace

std::vector<double> recordingCurves(const RecordingPoses& poses, const std::vector<int>& lags) {
  return recordingCurves(poses, lags, lags, 1, {}, nullptr);
}

std::vector<double> recordingCurves(const RecordingPoses& poses, const std::vector<int>& lags,
                                    const std::vector<int>& measured, double every,
                                    const RecordingStretches& stretches,
                                    std::vector<double>* tapered) {
  const std::size_t n = lags.size();
  const std::size_t frames = poses.x.size();
  const int coarser = static_cast<int>(std::lround(std::log2(every)));
  std::vector<double> curves(2 * n, kNan);
  std::vector<double> weights;  // of windows whose middle lies at half a frame
  if (tapered != nullptr) {
    tapered->assign(2 * n, kNan);
    weights.resize(2 * frames);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      weights[k] = taper(0.5 * static_cast<double>(k) / static_cast<double>(frames - 1));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto lag = static_cast<std::size_t>(lags[i]);
    double r2 = 0;
    double a2 = 0;
    std::size_t windows = 0;
    std::size_t angular_windows = 0;
    TaperedSum places;
    TaperedSum headings;
    const auto add = [&](std::size_t start) {
      const std::size_t end = start + lag;
      if (!joined(stretches.of_places, start, end)) return;
      const double dx = poses.x[end] - poses.x[start];
      const double dy = poses.y[end] - poses.y[start];
      const double square = dx * dx + dy * dy;
      r2 += square;
      ++windows;
      if (tapered != nullptr) places.add(weights[start + end], square);
      if (!joined(stretches.of_headings, start, end)) return;
      const double turn = poses.theta[end] - poses.theta[start];
      a2 += turn * turn;
      ++angular_windows;
      if (tapered != nullptr) headings.add(weights[start + end], turn * turn);
    };
    if (measured[i] < kDenseLags) {
      const int step = std::max(0, static_cast<int>(stepOf(measured[i])) - coarser);
      for (std::size_t end = lag; end < frames; ++end) {
        if (mostStepAt(end) >= static_cast<std::size_t>(step)) add(end - lag);
      }
    } else {
      const double stride = std::max(1.0, strideOf(octaveOf(measured[i])) / every);
      for (double start = 0; start + static_cast<double>(lag) < static_cast<double>(frames);
           start += stride) {
        add(static_cast<std::size_t>(start));
      }
    }
    if (windows > 0) curves[i] = r2 / static_cast<double>(windows);
    if (angular_windows > 0) curves[n + i] = a2 / static_cast<double>(angular_windows);
    if (tapered != nullptr) {
      (*tapered)[i] = places.mean();
      (*tapered)[n + i] = headings.mean();
    }
  }
  return curves;
}

SimulatedCurves simulateCurves(const BootstrapPlan& plan) {
  SimulatedCurves result;
  result.duration = plan.duration * (1 - plan.gaps.unseen);
  result.cut = plan.gaps.cut;
  // The period of the recordings is slightly longer than whole frames, so that it does not lock to
  // holds.
  const double every = std::max(1.0, std::round(plan.period / plan.frame_period));
  std::vector<int> frames;
  std::vector<int> measured;
  for (const double lag : plan.lags) {
    frames.push_back(std::max(1, static_cast<int>(std::lround(lag / plan.period))));
    measured.push_back(std::max(1, static_cast<int>(std::lround(lag / plan.frame_period))));
    result.lags.push_back(frames.back() * plan.period);
  }
  const ExactLaw exact(plan.law);
  for (const double lag : result.lags) {
    result.law.push_back(exact.msd(lag) + 4 * plan.sigma * plan.sigma);
  }
  for (const double lag : result.lags) {
    result.law.push_back(exact.angularMsd(lag) + 2 * plan.sigma_theta * plan.sigma_theta);
  }
  const RecordingPlan recording{plan.law,   plan.duration,    plan.period,
                                plan.sigma, plan.sigma_theta, 0};
  RecordingPoses poses;
  RecordingStretches stretches;
  std::vector<double> tapered;
  for (int i = 0; i < plan.recordings; ++i) {
    const std::uint64_t seed = plan.seed + static_cast<std::uint64_t>(i);
    simulateRecording(recording, seed, poses);
    if (plan.gaps.lost > 0 || plan.gaps.cut) {
      stretches = drawStretches(plan.gaps, plan.frame_period, plan.period, poses.x.size(), ~seed);
    }
    const std::vector<double> curves =
        recordingCurves(poses, frames, measured, every, stretches, plan.taper ? &tapered : nullptr);
    // A recording without windows of some lag does not contribute to the covariance.
    bool whole = true;
    for (std::size_t column = 0; column < curves.size(); ++column) {
      const std::size_t lag = column % frames.size();
      const bool needed = column < frames.size() || plan.angular.empty() || plan.angular[lag];
      whole = whole && (!needed || (std::isfinite(curves[column]) &&
                                    (!plan.taper || std::isfinite(tapered[column]))));
    }
    if (!whole) continue;
    ++result.recordings;
    result.values.insert(result.values.end(), curves.begin(), curves.end());
    result.tapered.insert(result.tapered.end(), tapered.begin(), tapered.end());
  }
  return result;
}

double errorScale(const SimulatedCurves& recordings, double observed, double segments, double tau) {
  // Limited below, so that lags near the length of a segment have a finite error: to half of a
  // single segment; to less for many, some of which are longer than the mean.
  const double least = (segments > 1 ? 0.1 : 0.5) * observed;
  const double covered = recordings.cut ? observed : std::max(observed - segments * tau, least);
  return std::sqrt(std::max(recordings.duration - tau, 0.5 * recordings.duration) / covered);
}

double taperedScale(const SimulatedCurves& recordings, double observed, double segments,
                    double tau) {
  const double ends = std::max(recordings.duration - tau, 0.5 * recordings.duration);
  // (sum of the weights)^2 over the sum of their squares.
  constexpr double kLength = (1 - kRamp) * (1 - kRamp) / (1 - 1.25 * kRamp);
  return errorScale(recordings, observed, segments, tau) *
         std::sqrt(kLength * recordings.duration / ends);
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
  return error * errorScale(curves, observed, segments, tau);
}

}  // namespace lab::analysis
