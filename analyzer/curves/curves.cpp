#include "analyzer/curves/curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

#include "analyzer/curves/statistics.hpp"
#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kBlocksPerLag = 5;
constexpr std::size_t kEnoughBlocks = 12;
constexpr double kTrustedBlocks = 180;    // for lags beyond track / 180 blocks are not sufficient
constexpr double kRecordingsPerLag = 20;  // lags beyond recording / 20 are too skewed to judge
constexpr double kMinDraws = 100;         // draws or tumbles for a verdict
constexpr double kLimitZ = 4;
constexpr int kMinJudged = 5;
constexpr double kManyBlocks = 1e9;

double mean(double sum, std::uint32_t n) { return n > 0 ? sum / n : kNan; }

/// The means of all lags, raw and with the noise offset removed, as one vector for the jackknife.
class LagFunctions {
 public:
  /// @param offset of the noise in the MSD, used if the data do not determine it
  LagFunctions(const Estimator& estimator, const BlockData& data, double offset)
      : estimator_(estimator),
        lags_(data.lags),
        period_(data.frame_period),
        n_(data.lags.size()),
        offset_(finiteOrZero(offset)) {}

  std::vector<double> operator()(const BlockSums& sums) const {
    const Quantities q = estimator_(sums);
    const double offset = std::isfinite(q[kPositionOffset]) ? q[kPositionOffset] : offset_;
    const double joins = sums.joins / sums.time;
    const double angular_offset = finiteOrZero(q[kHeadingOffset]);
    std::vector<double> result(4 * n_);
    for (std::size_t i = 0; i < n_; ++i) {
      const LagSums& lag = sums.lags[i];
      result[i] = mean(lag.r2, lag.windows);
      result[n_ + i] = mean(lag.a2, lag.angular_windows);
      result[2 * n_ + i] = result[i] - offset * joinNoise(i, joins);
      result[3 * n_ + i] = result[n_ + i] - angular_offset;
    }
    return result;
  }

  /// Noise of windows across joins: the positions on both sides of a join are noisy too, and shared
  /// by these windows.
  [[nodiscard]] double joinNoise(std::size_t i, double joins_per_second) const {
    const double frames = lags_[i];
    return 1 + joins_per_second * period_ * (frames - 2);
  }

 private:
  const Estimator& estimator_;
  const std::vector<int>& lags_;
  double period_;
  std::size_t n_;
  double offset_;
};

/// The block errors of all lags, each from blocks long enough for it.
class LagErrors {
 public:
  LagErrors(const BlockData& data, const LagFunctions& functions)
      : data_(data), functions_(functions) {
    for (const auto& track : data.tracks) {
      for (const BlockSums& block : track) {
        native_ = std::max(native_, block.time);
      }
    }
  }

  struct Error {
    double raw = 0;        ///< Of the mean.
    double corrected = 0;  ///< Of the mean, less the noise offset.
    double freedom = 0;    ///< Degrees of freedom of both.
    bool enough = false;   ///< Enough blocks, each long enough.
  };

  Error at(double tau, std::size_t column, std::size_t corrected_column) {
    // Block lengths are powers of two, so that few distinct groupings are needed.
    double length = native_;
    while (length < kBlocksPerLag * tau) {
      length *= 2;
    }
    const Replicates* replicates = &grouped(length);
    const bool enough = replicates->shares.size() >= kEnoughBlocks;
    while (replicates->shares.size() < kEnoughBlocks && length > native_) {
      length /= 2;
      replicates = &grouped(length);
    }
    // Windows extend by tau into the block before, so neighbouring blocks are correlated.
    const double overlap = enough ? 1 / std::sqrt(1 - tau / (4 * length)) : 1;
    return {overlap * replicates->sigma(column), overlap * replicates->sigma(corrected_column),
            replicates->degreesOfFreedom(), enough};
  }

 private:
  const Replicates& grouped(double length) {
    auto found = cache_.find(length);
    if (found == cache_.end()) {
      found = cache_.emplace(length, jackknife(groupBlocks(data_, length), functions_)).first;
    }
    return found->second;
  }

  const BlockData& data_;
  const LagFunctions& functions_;
  double native_ = 0;
  std::map<double, Replicates> cache_;
};

/// The law at the measured speed, if the difference may be a calibration error.
ExactLaw calibrated(const ProgramLaw& law, double speed, double tolerance) {
  const std::optional<double> constant = law->constantSpeed();
  const bool close = constant && std::abs(speed / *constant - 1) <= tolerance;
  return ExactLaw(close ? law.withSpeed(speed) : law);
}

}  // namespace

double modelMsdError(const ExactLaw& law, double tau, double observed) {
  return law.program()->relativeMsdError(tau, law.msd(tau), observed);
}

double modelAngularError(const ExactLaw& law, double tau, double observed) {
  return law.program()->relativeAngularError(tau, observed);
}

Curves curves(const ProgramLaw& law, const BlockData& data, const CurveOptions& options) {
  Curves result;
  const double observed = data.observed();
  const ExactLaw exact(law);
  if (!(observed > 0)) {
    return result;
  }
  const std::size_t n = data.lags.size();
  const BlockSums total = data.total();
  const Estimator estimator(law, data);
  const double speed = estimator(total)[kSpeed];
  const ExactLaw reference = calibrated(law, speed, options.speed_tolerance);
  const LagFunctions functions(estimator, data, options.offset);
  // Without headings, only a fit determines the tracker noise.
  const bool by_fit = !std::isfinite(estimator(total)[kPositionOffset]);
  const bool noise_known = !by_fit || std::isfinite(options.offset);
  const std::vector<double> means = functions(total);
  LagErrors errors(data, functions);
  const bool enough_draws = observed / law->drawTime() >= kMinDraws;
  const auto tracks = static_cast<double>(data.tracks.size());
  const double segments = std::max(tracks, total.segments);
  const RecordingGaps gaps = gapsOf(data, total);
  const auto recording_error = [&](bool angular, double tau) {
    return options.recordings != nullptr && kTrustedBlocks * tau > observed / tracks
               ? relativeError(*options.recordings, angular, tau, observed, segments)
               : kNan;
  };

  for (std::size_t i = 0; i < n; ++i) {
    const double tau = data.lagTime(i, total);
    const LagSums& sums = total.lags[i];
    const auto point = [&](bool angular) {
      CurvePoint p;
      p.tau = tau;
      p.windows = angular ? sums.angular_windows : sums.windows;
      p.value = mean(angular ? sums.a2 : sums.r2, angular ? sums.angular_windows : sums.windows);
      const double fourth =
          mean(angular ? sums.a4 : sums.r4, angular ? sums.angular_windows : sums.windows);
      p.kurtosis = fourth / (p.value * p.value);
      p.exact = angular ? exact.angularMsd(tau) : exact.msd(tau);
      p.paper = angular ? paperAngularMsd(law, tau) : law->paperMsd(tau);
      const double expected = angular ? reference.angularMsd(tau) : reference.msd(tau);
      const std::size_t column = angular ? n + i : i;
      LagErrors::Error error = errors.at(tau, column, 2 * n + column);
      // Cuts leave few windows of long lags, in segments that are not representative.
      const double covered = coveredShare(gaps, tau / data.frame_period, sums, angular);
      const bool is_cut = gaps.cut || (angular && sums.angular_windows < sums.windows);
      const double seen = std::max(covered * observed, tau);
      const double model = expected * (angular ? modelAngularError(exact, tau, seen)
                                               : modelMsdError(exact, tau, seen));
      const double simulated = angular && covered < kLeastCovered ? kNan : recording_error(angular, tau);
      p.noise = p.value - means[2 * n + column];
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
      p.z = normalDeviate(
          (means[2 * n + column] - expected) /
              std::hypot(error.corrected, options.systematic_floor * expected, offset_error),
          error.freedom);
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
  if (verdict.judged >= kMinJudged) {
    verdict.kind = verdict.max_z < kLimitZ ? VerdictKind::kAgrees : VerdictKind::kDisagrees;
  }
  return verdict;
}

}  // namespace lab::analysis
