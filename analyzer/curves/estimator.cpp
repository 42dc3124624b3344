#include "analyzer/curves/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "analyzer/curves/lags.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kRecordingsPerSlope = 20;  // minimal length of a recording, in lags of the slope

}  // namespace

Estimator::Estimator(const ProgramLaw& law, const BlockData& data)
    : law_(law), total_(data.total()) {
  held_ = law->held();
  wheels_ = law->drawnWheels();
  runs_ = law->runs();
  const std::size_t n = data.lags.size();
  for (std::size_t i = 0; i < n; ++i) lag_times_.push_back(data.lagTime(i, total_));
  first_lag_ = lag_times_.front();
  const bool dense = n > 2 && data.lags[0] == 1 && data.lags[2] == 3;
  third_lag_ = dense ? 2 : 0;
  const double change = law->changeTime();
  const double turn = held_                   ? held_->hold
                      : runs_                 ? runs_->turn_time
                      : std::isfinite(change) ? change
                                              : 0;
  hold_ = nearestLag(data.lags, turn / data.frame_period);
  two_holds_ = nearestLag(data.lags, 2 * turn / data.frame_period);
  const double persistence = law->persistenceTime();
  slope_begin_ = nearestLag(data.lags, 5 * persistence / data.frame_period);
  slope_end_ = nearestLag(data.lags, 10 * persistence / data.frame_period);
  const bool reached = lag_times_[slope_end_] > 8 * persistence && slope_end_ > slope_begin_;
  const bool enough = kRecordingsPerSlope * lag_times_[slope_end_] <= total_.time;
  slope_time_ = reached && enough ? lag_times_[slope_end_] - lag_times_[slope_begin_] : 0;

  noise_lags_ = {0, hold_, two_holds_};
  needed_ = {0, hold_, two_holds_, slope_begin_, slope_end_};
  if (dense) needed_.insert(needed_.end(), {1, 2});
  for (std::vector<std::size_t>* lags_once : {&noise_lags_, &needed_}) {
    std::ranges::sort(*lags_once);
    lags_once->erase(std::unique(lags_once->begin(), lags_once->end()), lags_once->end());
  }

  const ExactLaw exact(law);
  const auto unit_law = law->curvesAtMean(1);
  const auto noise_law = law->curvesAtMean(0);
  const double turning2 = held_ ? 2 * law->rotationalDiffusivity() / held_->hold : 1;
  shape_.assign(n, kNan);
  mean_part_ = noise_part_ = shape_;
  for (const std::size_t i : {std::size_t{0}, hold_, two_holds_}) {
    const double tau = lag_times_[i];
    shape_[i] = exact.angularMsd(tau) / turning2;
    if (noise_law) noise_part_[i] = noise_law->msd(tau);
    if (unit_law) mean_part_[i] = unit_law->msd(tau) - noise_part_[i];
  }
}

double Estimator::msd(const BlockSums& sums, std::size_t i) const {
  return sums.lags[i].windows > 0 ? sums.lags[i].r2 / sums.lags[i].windows : kNan;
}

double Estimator::angular(const BlockSums& sums, std::size_t i) const {
  return sums.lags[i].angular_windows > 0 ? sums.lags[i].a2 / sums.lags[i].angular_windows : kNan;
}

double Estimator::reach(Quantity quantity) const {
  if (quantity == kSlopeDiffusivity) {
    return lag_times_[slope_end_];
  }
  if (runs_) return 1 / runs_->rate + runs_->turn_time;
  return lag_times_[two_holds_];
}

/// <omega^2> from the difference of two lags; nan if they are the same.
double Estimator::turningScale(const BlockSums& sums, std::size_t from, std::size_t to) const {
  return to > from ? (angular(sums, to) - angular(sums, from)) / (shape_[to] - shape_[from]) : kNan;
}

TrackerNoise Estimator::noise(const BlockSums& sums) const {
  const double scale =
      hold_ > 0 ? turningScale(sums, 0, hold_) : turningScale(sums, hold_, two_holds_);
  TrackerNoise noise;
  noise.heading_offset = angular(sums, 0) - scale * shape_[0];
  const double heading_noise = std::isfinite(noise.heading_offset) ? 0.5 * noise.heading_offset : 0;
  const double across = sums.steps > 0 ? sums.sideways2 / sums.steps : kNan;
  // Noise of the heading turns part of the forward step sideways.
  noise.position_offset = 2 * (across - 0.5 * heading_noise * (msd(sums, 0) - 2 * across));
  return noise;
}

double Estimator::speed(const BlockSums& sums, const TrackerNoise& noise) const {
  const double heading_noise = std::isfinite(noise.heading_offset) ? 0.5 * noise.heading_offset : 0;
  double correction = heading_noise / 4;
  if (!held_ && !runs_) {
    correction = chordOfUnknownTurning(sums);
  } else if (held_) {
    // The chord of an arc is shorter than the arc; between runs, a robot turns on the spot.
    correction += (angular(sums, 0) - 2 * heading_noise) / 24;
  }
  return sums.forward_time > 0 ? sums.forward / sums.forward_time * (1 + correction) : kNan;
}

/// Correction of the forward step for an unknown program. The heading may turn uniformly or
/// randomly: the angular MSD over n frames is a n^2 or b n, plus c for noise. A uniform turn
/// shortens the step along the mean heading by a/24; a random one, like noise, by b/8.
double Estimator::chordOfUnknownTurning(const BlockSums& sums) const {
  const double one = angular(sums, 0);
  const double even =
      third_lag_ > 0 ? 0.5 * (angular(sums, third_lag_) - 2 * angular(sums, third_lag_ - 1) + one)
                     : kNan;
  if (!std::isfinite(even)) return one / 24;
  // Rounding makes `one` slightly negative where a jackknife leaves out the only turn.
  return one / 8 - std::clamp(even, 0.0, std::max(one, 0.0)) / 12;
}

Quantities Estimator::operator()(const BlockSums& sums) const {
  Quantities q;
  q.fill(kNan);
  if (held_) {
    q[kRotationalDiffusivity] = 0.5 * held_->hold * turningScale(sums, hold_, two_holds_);
  }
  const TrackerNoise tracker = noise(sums);
  q[kPositionOffset] = tracker.position_offset;
  q[kHeadingOffset] = tracker.heading_offset;
  q[kSpeed] = speed(sums, tracker);
  if (runs_) {
    q[kTumbleRate] = sums.run_time > 0 ? sums.tumbles / sums.run_time : kNan;
    // In frames in which a tumble begins or ends, part of a run is projected on a heading that has
    // turned: to lowest order a loss of <omega^2> dt^3 / 48 per tumble.
    const double omega2 =
        std::numbers::pi * std::numbers::pi / (3 * runs_->turn_time * runs_->turn_time);
    const double smeared = q[kTumbleRate] * omega2 * std::pow(first_lag_, 3) / 48;
    q[kSpeed] *= sums.run_time > 0 ? sums.run_span / sums.run_time * (1 + smeared) : kNan;
  }
  if (wheels_) {
    const double va = law_->isDiffusive() ? 0 : q[kSpeed];
    // (V / V programmed)^2 from the difference of two lags.
    const auto ratio = [&](std::size_t from, std::size_t to) {
      const double mean_part = va * va * (mean_part_[to] - mean_part_[from]);
      return to > from ? (msd(sums, to) - msd(sums, from) - mean_part) /
                             (noise_part_[to] - noise_part_[from])
                       : kNan;
    };
    q[kTranslationalDiffusivity] = law_->translationalDiffusivity() * ratio(hold_, two_holds_);
    q[kAmplitude] =
        wheels_->half_width * std::sqrt(hold_ > 0 ? ratio(0, hold_) : ratio(hold_, two_holds_));
  }
  if (slope_time_ > 0) {
    q[kSlopeDiffusivity] = (msd(sums, slope_end_) - msd(sums, slope_begin_)) / (4 * slope_time_);
  }
  return q;
}

}  // namespace lab::analysis
