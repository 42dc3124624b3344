#include "analyzer/curves/frame_phases.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "analyzer/curves/estimates.hpp"
#include "analyzer/laws.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr int kMostPhases = 16;     // with more, deviations are below the errors of draws
constexpr double kMostFrames = 64;  // of a lag, likewise
constexpr double kWithin = 3;       // standard deviations of the clocks

}  // namespace

FramePhases::FramePhases(const ProgramLaw& law, double frame_period, double observed, double tracks)
    : FramePhases(law, kNan, kNan, frame_period, observed, tracks) {
  const ExactLaw exact(law);
  if (left_ == 0 || !exact.exists()) return;
  if (const auto noise = law->heldNoise()) {
    noise_ = std::make_shared<const PhasedNoise>(*noise);
    drawn_wheels_ = law->drawnWheels().has_value();
  } else {
    setTurning(hold_, exact.angularMsd(hold_));
  }
}

FramePhases::FramePhases(const ProgramLaw& law, double tau, double angular_msd, double frame_period,
                         double observed, double tracks)
    : hold_(law->steadyHold()) {
  if (!(hold_ > 0) || !(observed > 0)) return;
  // After phases_ frames, a whole number of holds has passed.
  double apart = 1;
  for (phases_ = 1; phases_ <= kMostPhases; ++phases_) {
    const double holds = phases_ * frame_period / hold_;
    const double whole = std::max(1.0, std::round(holds));
    apart = holds / whole - 1;
    period_ = whole * hold_ / phases_;
    if (std::abs(apart) <= kWithin * kClockError) break;
  }
  if (phases_ > kMostPhases) return;
  const double least = kUnlucky * kClockError * std::sqrt(std::numbers::pi / 2) *
                       std::exp(0.5 * std::pow(apart / kClockError, 2));
  const double drift = phases_ * observed / tracks / hold_ * least;  // in distances of phases
  const double slow = 1 / (std::numbers::pi * drift);
  left_ = std::min(1.0, slow) / std::sqrt(tracks);
  // The mean of min(1, (a / drift)^2) over clocks, whose density near drift 0 is constant.
  usual_ = std::min(1.0, 2 * kUnlucky * slow) / std::min(1.0, slow * slow);
  setTurning(tau, angular_msd);
}

// Of a turning rate that is drawn anew after each hold.
void FramePhases::setTurning(double tau, double angular_msd) {
  const double turning2 = angular_msd / (hold_ * (tau - hold_ / 3));
  if (!(turning2 > 0)) return;
  noise_ = std::make_shared<const PhasedNoise>(
      HeldNoise::uniformTurning(0, std::sqrt(3 * turning2), hold_));
}

FramePhases::Deviations FramePhases::of(bool angular, double frames) const {
  Deviations deviations{};
  if (!noise_ || frames > kMostFrames || !(angular || drawn_wheels_)) return deviations;
  const double tau = frames * period_;
  double mean = 0;
  for (int i = 0; i < kPhases; ++i) {
    double& one = deviations[static_cast<std::size_t>(i)];
    one = commensurateMean(hold_, phases_, hold_ / phases_ * i / kPhases, [&](double to_update) {
      return angular ? noise_->angularMsd(tau, to_update) : noise_->msd(tau, to_update);
    });
    mean += one / kPhases;
  }
  for (double& one : deviations) one = left_ * (one - mean);
  return deviations;
}

std::vector<double> phaseErrors(const FramePhases& phases, const Estimator& estimator,
                                const std::vector<int>& lags) {
  if (!phases.matter()) return std::vector<double>(lags.size(), 0);
  std::vector<FramePhases::Deviations> all;
  for (const int lag : lags) all.push_back(phases.of(true, lag));
  for (std::size_t phase = 0; phase < FramePhases::kPhases; ++phase) {
    // The noise is a linear function of the curve.
    BlockSums curve;
    curve.lags.resize(lags.size());
    for (const std::size_t i : estimator.noiseLags()) {
      curve.lags[i].angular_windows = 1;
      curve.lags[i].a2 = all[i][phase];
    }
    const double noise = finiteOrZero(estimator.noise(curve).heading_offset);
    for (FramePhases::Deviations& one : all) one[phase] -= noise;
  }
  return errorsOf(all);
}

std::vector<double> phaseErrors(const FramePhases& phases, const std::vector<int>& lags) {
  std::vector<FramePhases::Deviations> all;
  for (const int lag : lags) all.push_back(phases.of(false, lag));
  return errorsOf(all);
}

std::vector<double> errorsOf(const std::vector<FramePhases::Deviations>& lags) {
  std::vector<double> errors;
  for (const FramePhases::Deviations& deviations : lags) {
    double sum = 0;
    for (const double one : deviations) sum += one * one;
    errors.push_back(std::sqrt(sum / FramePhases::kPhases));
  }
  return errors;
}

}  // namespace lab::analysis
