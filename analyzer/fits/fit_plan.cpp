#include "analyzer/fits/fit_plan.hpp"

#include <algorithm>
#include <cmath>

namespace lab::analysis {
namespace {

constexpr double kHoldFrames = 50;     // largest number of frames in a simulated hold
constexpr double kRecordingLags = 30;  // length of a simulated recording, in longest lags
constexpr double kMostFrames = 16000;  // largest number of frames in a simulated recording
constexpr double kLagsPerTrack = 5;    // length of a track, in longest lags

}  // namespace

std::vector<FitParameter> freeParameters(const ProgramLaw& law, const FitOptions& options) {
  std::vector<FitParameter> free = law->fitParameters();
  for (const FitParameter& time : law->fitTimes()) {
    if (std::ranges::find(options.free_times, time.name) != options.free_times.end()) {
      free.push_back(time);
    }
  }
  return free;
}

FitPlan planFit(const ProgramLaw& law, const MeasuredCurves& curves, const FitOptions& options) {
  FitPlan plan;
  if (!ExactLaw(law).exists() || curves.lags.empty() || !(curves.frame_period > 0)) return plan;
  const double dt = curves.frame_period;
  const double track = curves.observed / curves.tracks;
  const double base = std::max(law->changeTime(), dt);
  double longest = std::min(std::max(law->longestChange(), 8 * dt), track / kLagsPerTrack);
  if (options.longest_lag > 0) longest = std::min(longest, options.longest_lag);
  while (curves.gaps.covered(longest / dt) < kLeastCovered) longest *= 0.9;
  std::vector<double> wanted;
  for (const double part : {0.2, 0.3, 0.44, 0.67}) wanted.push_back(part * base);
  for (double lag = base; lag <= 1.02 * longest; lag *= std::sqrt(2.0)) wanted.push_back(lag);
  for (const double lag : wanted) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < curves.lags.size(); ++i) {
      if (std::abs(curves.lags[i] - lag) < std::abs(curves.lags[best] - lag)) best = i;
    }
    const bool near = curves.lags[best] < 1.25 * lag && curves.lags[best] < 1.05 * longest;
    if (near && (plan.lags.empty() || best > plan.lags.back())) plan.lags.push_back(best);
  }
  if (plan.lags.empty()) return plan;
  const double last = curves.lags[plan.lags.back()];
  plan.duration = std::min(track, kRecordingLags * last / curves.gaps.covered(last / dt));
  const double every = std::max({1.0, std::floor(base / kHoldFrames / dt + 1e-9),
                                 std::ceil(plan.duration / dt / kMostFrames)});
  plan.period = every * dt * kDrift;
  return plan;
}

SimulatedCurves simulateForFit(const ProgramLaw& law, double offset, double angular_offset,
                               const MeasuredCurves& curves, const FitPlan& plan,
                               const FitOptions& options) {
  BootstrapPlan recordings;
  recordings.law = law;
  recordings.sigma = std::sqrt(std::max(0.0, offset / 4));
  recordings.sigma_theta = std::sqrt(std::max(0.0, angular_offset / 2));
  recordings.period = plan.period;
  recordings.frame_period = curves.frame_period;
  recordings.gaps = curves.gaps;
  recordings.duration = plan.duration;
  recordings.taper = true;
  recordings.recordings = options.recordings;
  recordings.seed = options.seed;
  for (const std::size_t lag : plan.lags) {
    recordings.lags.push_back(curves.lags[lag]);
    recordings.angular.push_back(std::isfinite(curves.angular_msd[lag]));
  }
  return simulateCurves(recordings);
}

}  // namespace lab::analysis
