#include "analyzer/curves/curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "analyzer/curves/frame_phases.hpp"
#include "analyzer/curves/hold_period.hpp"
#include "analyzer/curves/lag_errors.hpp"
#include "analyzer/curves/statistics.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kTrustedBlocks = 180;    // for lags beyond track / 180 blocks are not sufficient
constexpr double kRecordingsPerLag = 20;  // lags beyond recording / 20 are too skewed to judge
constexpr double kMinDraws = 100;         // draws or tumbles for a verdict
constexpr double kLimitZ = 4;
constexpr int kMinJudged = 5;
constexpr double kManyBlocks = 1e9;

double mean(double sum, std::uint32_t n) { return n > 0 ? sum / n : kNan; }

/// The MSD of the law at the measured speed over that at the programmed one, if the difference may
/// be a calibration error; else 1. At a constant speed the MSD is proportional to its square.
double calibration(const ProgramLaw& law, double speed, double tolerance) {
  const std::optional<double> constant = law->constantSpeed();
  const double ratio = constant ? speed / *constant : 1;
  return std::abs(ratio - 1) <= tolerance ? ratio * ratio : 1;
}

}  // namespace

Curves curves(const ProgramLaw& law, const BlockData& data, const CurveOptions& options) {
  if (!(data.observed() > 0)) return {};
  return curves(Estimator(law, data), data, options);
}

Curves curves(const Estimator& estimator, const BlockData& data, const CurveOptions& options) {
  Curves result;
  const ProgramLaw& law = estimator.law();
  const BlockSums& total = estimator.total();
  const double observed = total.time;
  result.hold = holdPeriod(data.holds);
  result.turning = turningRate(law, total);
  result.draws = drawShape(estimator, data);
  const std::size_t n = data.lags.size();
  const ExactLaw exact(law);
  const double calibrated = calibration(law, estimator(total)[kSpeed], options.speed_tolerance);
  // Without headings, only a fit determines the tracker noise.
  const bool by_fit = !std::isfinite(estimator.noise(total).position_offset);
  const bool noise_known = !by_fit || std::isfinite(options.offset);
  const LagNoise noise = LagNoise::of(estimator, total, options.offset);
  std::vector<double> times;
  for (std::size_t i = 0; i < n; ++i) times.push_back(data.lagTime(i, total));
  const LagErrors errors = lagErrors(data, estimator, times, options.offset);
  const bool enough_draws = observed / law->drawTime() >= kMinDraws;
  const auto tracks = static_cast<double>(data.tracks.size());
  const double segments = std::max(tracks, total.segments);
  const FramePhases phases(law, data.frame_period, observed, tracks);
  result.frames_in_step = phases.matter() ? phases.repeat() : 0;
  const std::vector<double> angular_phases = phaseErrors(phases, estimator, data.lags);
  const std::vector<double> msd_phases = phaseErrors(phases, data.lags);
  const ExactLaw slow(law->held() ? law.slowed(1 + kClockError) : law);
  const RecordingGaps gaps = gapsOf(data, total);
  const auto recording_error = [&](bool angular, double tau) {
    return options.recordings != nullptr && kTrustedBlocks * tau > observed / tracks
               ? relativeError(*options.recordings, angular, tau, observed, segments)
               : kNan;
  };

  for (std::size_t i = 0; i < n; ++i) {
    const double tau = times[i];
    const LagSums& sums = total.lags[i];
    const auto point = [&](bool angular) {
      // Cuts leave few windows of long lags, in segments that are not representative.
      const double covered = coveredShare(gaps, tau / data.frame_period, sums, angular);
      const bool is_cut = gaps.cut || (angular && sums.angular_windows < sums.windows);
      const double seen = std::max(covered * observed, tau);
      CurvePoint p;
      p.tau = tau;
      p.windows = angular ? sums.angular_windows : sums.windows;
      p.value = mean(angular ? sums.a2 : sums.r2, angular ? sums.angular_windows : sums.windows);
      const double fourth =
          mean(angular ? sums.a4 : sums.r4, angular ? sums.angular_windows : sums.windows);
      p.kurtosis = fourth / (p.value * p.value);
      p.exact = angular ? exact.angularMsd(tau) : exact.msd(tau);
      p.paper = angular ? paperAngularMsd(law, tau) : law->paperMsd(tau);
      const double expected = angular ? p.exact : calibrated * p.exact;
      LagError error = (angular ? errors.angular_msd : errors.msd)[i];
      const double model = expected * (angular ? law->relativeAngularError(tau, seen)
                                               : law->relativeMsdError(tau, p.exact, seen));
      const double simulated =
          angular && covered < kLeastCovered ? kNan : recording_error(angular, tau);
      const double offset = angular ? noise.heading : noise.inMsd(data.lags[i], data.frame_period);
      const double corrected = p.value - offset;
      p.noise = p.value - corrected;
      if (std::isfinite(simulated)) {
        error.raw = simulated * (expected + p.noise);
        error.corrected = simulated * expected;
        error.freedom = kManyBlocks;
      } else if (!error.enough || is_cut) {
        error.raw = std::fmax(error.raw, model);
      }
      const bool own = !error.enough || angular || law->predictsMsdError();
      if (!std::isfinite(simulated) && !(error.corrected > model) && own) {
        error.corrected = model;
        error.freedom = kManyBlocks;
      }
      p.sigma = p.windows > 0 ? error.raw : kNan;
      p.n_eff = (fourth - p.value * p.value) / (p.sigma * p.sigma);
      const double offset_error = by_fit && !angular ? options.offset_sigma : 0;
      const double phase_error = (angular ? angular_phases : msd_phases)[i];
      const double clock_error = angular ? (slow.angularMsd(tau) - p.exact) / std::sqrt(tracks) : 0;
      const double known = std::hypot(options.systematic_floor * expected,
                                      std::hypot(offset_error, phase_error, clock_error));
      const double deviation = error.freedom == kManyBlocks
                                   ? expected * normalised(corrected / expected)
                                   : corrected - expected;
      p.z = normalDeviate(deviation / std::hypot(error.corrected, known), error.freedom);
      p.selection_biased = options.unbiased_lag > 0 && tau > options.unbiased_lag;
      p.judged = enough_draws && noise_known && !p.selection_biased && std::isfinite(p.z) &&
                 covered >= kLeastCovered && kRecordingsPerLag * tau <= covered * observed;
      return p;
    };
    const CurvePoint msd_point = point(false);
    const CurvePoint angular_point = point(true);
    result.msd.push_back(msd_point);
    result.angular_msd.push_back(angular_point);
  }
  return result;
}

namespace {

/// Numbers that the curves hardly depend on.
void judgeNumbers(const Curves& curves, Verdict& verdict) {
  const auto exceeds = [&verdict](double z) {
    if (!(std::abs(z) > verdict.max_z)) return false;
    verdict.max_z = std::abs(z);
    verdict.tau = 0;
    verdict.angular = true;
    verdict.hold = verdict.turning = verdict.draws = false;
    return true;
  };
  if (curves.hold && exceeds(curves.hold->z)) {
    verdict.tau = curves.hold->value;
    verdict.hold = true;
  }
  if (curves.turning && exceeds(curves.turning->z)) verdict.turning = true;
  if (curves.draws && exceeds(curves.draws->z)) verdict.draws = true;
}

}  // namespace

Verdict judge(const Curves& curves) {
  Verdict verdict;
  for (const bool angular : {false, true}) {
    for (const CurvePoint& point : angular ? curves.angular_msd : curves.msd) {
      if (!point.judged) {
        continue;
      }
      ++verdict.judged;
      if (std::abs(point.z) > verdict.max_z) {
        verdict.max_z = std::abs(point.z);
        verdict.tau = point.tau;
        verdict.angular = angular;
      }
    }
  }
  if (verdict.judged >= kMinJudged) judgeNumbers(curves, verdict);
  if (verdict.judged >= kMinJudged) {
    verdict.kind = verdict.max_z < kLimitZ ? VerdictKind::kAgrees : VerdictKind::kDisagrees;
  }
  return verdict;
}

}  // namespace lab::analysis
