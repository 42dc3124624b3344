#include "analyzer/curves/lag_errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kBlocksPerLag = 5;
constexpr std::size_t kEnoughBlocks = 12;

/// Jackknife errors (Replicates::sigmaOf()) of many means in a single pass: with
/// u = without - value, h = 1 / share and U the sum of (1 - share) u, a pseudo-value less its mean
/// is U - (h - 1) u.
class JackknifeSums {
 public:
  explicit JackknifeSums(std::size_t means) : means_(means), kept_(means), squares_(means) {}

  /// Adds the u of one group.
  void add(const std::vector<double>& u, double share) {
    const double kept = 1 - share;
    const double inverse = 1 / share - 1;
    for (std::size_t k = 0; k < means_.size(); ++k) {
      kept_[k] += kept * u[k];
      means_[k] += u[k];
      squares_[k] += inverse * u[k] * u[k];
    }
  }

  /// @param inverses sum of 1 / (h - 1)
  [[nodiscard]] double sigma(std::size_t k, std::size_t groups, double inverses) const {
    if (groups < 2) return units::kNan;
    const double variance = kept_[k] * (kept_[k] * inverses - 2 * means_[k]) + squares_[k];
    return std::sqrt(std::max(variance, 0.0) / static_cast<double>(groups));
  }

 private:
  std::vector<double> means_;  ///< Sums of u.
  std::vector<double> kept_;
  std::vector<double> squares_;
};

/// Sums and numbers of windows at the lags of a level.
struct LagColumns {
  explicit LagColumns(std::size_t n) : sum(n), windows(n) {}
  std::vector<double> sum;
  std::vector<double> windows;

  [[nodiscard]] double mean(std::size_t k) const { return sum[k] / windows[k]; }
};

/// Groups of blocks of one length, and the lags that use them.
struct Level {
  std::vector<BlockGroup> groups;
  std::vector<std::size_t> lags;
};

class Jackknife {
 public:
  Jackknife(const BlockData& data, const Estimator& estimator, double offset)
      : data_(data), estimator_(estimator), offset_(offset) {}

  /// Sets raw, corrected and freedom of the errors at the lags of a level.
  void run(const Level& level, LagErrors& errors) const {
    const BlockSums total = totalOf(level.groups, data_, estimator_.total());
    const LagNoise all_noise = LagNoise::of(estimator_, total, offset_);
    BlockSums rest = total;
    const std::size_t n = level.lags.size();
    LagColumns msd(n);
    LagColumns angular(n);
    take(total.lags, level.lags, msd, angular);
    LagColumns msd_of_group(n);
    LagColumns angular_of_group(n);
    std::vector<double> u(n);
    JackknifeSums raw(n);
    JackknifeSums corrected(n);
    JackknifeSums angular_raw(n);
    JackknifeSums angular_corrected(n);
    std::vector<double> shares;
    double inverses = 0;
    for (const BlockGroup& group : level.groups) {
      const double share = group.time / total.time;
      shares.push_back(share);
      inverses += share / (1 - share);
      const LagNoise noise = noiseWithout(group, total, rest);
      take(sumsOf(group, level.lags), level.lags, msd_of_group, angular_of_group);
      withoutGroup(msd, msd_of_group, u);
      raw.add(u, share);
      for (std::size_t k = 0; k < n; ++k) {
        const int lag = data_.lags[level.lags[k]];
        u[k] -= noise.inMsd(lag, data_.frame_period) - all_noise.inMsd(lag, data_.frame_period);
      }
      corrected.add(u, share);
      withoutGroup(angular, angular_of_group, u);
      angular_raw.add(u, share);
      for (double& one : u) one -= noise.heading - all_noise.heading;
      angular_corrected.add(u, share);
    }
    const double freedom = degreesOfFreedom(shares);
    const auto fill = [&](LagError& error, std::size_t k, const JackknifeSums& of_raw,
                          const JackknifeSums& of_corrected) {
      error.raw = of_raw.sigma(k, shares.size(), inverses);
      error.corrected = of_corrected.sigma(k, shares.size(), inverses);
      error.freedom = freedom;
    };
    for (std::size_t k = 0; k < n; ++k) {
      fill(errors.msd[level.lags[k]], k, raw, corrected);
      fill(errors.angular_msd[level.lags[k]], k, angular_raw, angular_corrected);
    }
  }

 private:
  /// @param rest only what the noise follows from is kept up to date
  LagNoise noiseWithout(const BlockGroup& group, const BlockSums& total, BlockSums& rest) const {
    rest.time = total.time;
    rest.steps = total.steps;
    rest.sideways2 = total.sideways2;
    rest.joins = total.joins;
    for (const std::size_t i : estimator_.noiseLags()) rest.lags[i] = total.lags[i];
    for (std::size_t b = group.begin; b < group.end; ++b) {
      const BlockSums& block = (*group.track)[b];
      rest.time -= block.time;
      rest.steps -= block.steps;
      rest.sideways2 -= block.sideways2;
      rest.joins -= block.joins;
      for (const std::size_t i : estimator_.noiseLags()) rest.lags[i] -= block.lags[i];
    }
    return LagNoise::of(estimator_, rest, offset_);
  }

  static void take(const std::vector<LagSums>& from, const std::vector<std::size_t>& lags,
                   LagColumns& msd, LagColumns& angular) {
    for (std::size_t k = 0; k < lags.size(); ++k) {
      const LagSums& sums = from[lags[k]];
      msd.sum[k] = sums.r2;
      msd.windows[k] = sums.windows;
      angular.sum[k] = sums.a2;
      angular.windows[k] = sums.angular_windows;
    }
  }

  /// The means without a group, less the means of all; nan without windows.
  static void withoutGroup(const LagColumns& all, const LagColumns& group, std::vector<double>& u) {
    for (std::size_t k = 0; k < u.size(); ++k) {
      const double windows = all.windows[k] - group.windows[k];
      const double mean = (all.sum[k] - group.sum[k]) / windows;
      u[k] = (windows > 0 ? mean : units::kNan) - all.mean(k);
    }
  }

  /// The sums of a group at some lags; valid until the next call.
  const std::vector<LagSums>& sumsOf(const BlockGroup& group,
                                     const std::vector<std::size_t>& lags) const {
    if (group.end == group.begin + 1) return (*group.track)[group.begin].lags;
    sums_.resize(data_.lags.size());
    for (const std::size_t i : lags) sums_[i] = LagSums{};
    for (std::size_t b = group.begin; b < group.end; ++b) {
      const std::vector<LagSums>& block = (*group.track)[b].lags;
      for (const std::size_t i : lags) sums_[i] += block[i];
    }
    return sums_;
  }

  const BlockData& data_;
  const Estimator& estimator_;
  double offset_;
  mutable std::vector<LagSums> sums_;
};

}  // namespace

LagNoise LagNoise::of(const Estimator& estimator, const BlockSums& sums, double offset) {
  const TrackerNoise noise = estimator.noise(sums);
  return {std::isfinite(noise.position_offset) ? noise.position_offset : finiteOrZero(offset),
          finiteOrZero(noise.heading_offset), sums.joins / sums.time};
}

LagErrors lagErrors(const BlockData& data, const Estimator& estimator,
                    const std::vector<double>& times, double offset) {
  double native = 0;
  for (const BlockTrack& track : data.tracks) {
    for (const BlockSums& block : track) native = std::max(native, block.time);
  }
  // Block lengths are powers of two, so that there are few distinct groupings.
  std::map<double, Level> levels;
  const auto level = [&](double length) -> Level& {
    const auto [found, is_new] = levels.try_emplace(length);
    if (is_new) found->second.groups = groupBlocks(data, length);
    return found->second;
  };
  LagErrors errors;
  std::vector<double> overlaps;
  for (std::size_t i = 0; i < times.size(); ++i) {
    double length = native;
    while (length < kBlocksPerLag * times[i]) length *= 2;
    const bool enough = level(length).groups.size() >= kEnoughBlocks;
    // Windows extend by the lag into the block before, so neighbouring blocks are correlated.
    overlaps.push_back(enough ? 1 / std::sqrt(1 - times[i] / (4 * length)) : 1);
    while (level(length).groups.size() < kEnoughBlocks && length > native) length /= 2;
    level(length).lags.push_back(i);
    errors.msd.push_back({.enough = enough});
    errors.angular_msd.push_back({.enough = enough});
  }
  const Jackknife jackknife(data, estimator, offset);
  for (const auto& [length, one] : levels) {
    if (!one.lags.empty()) jackknife.run(one, errors);
  }
  for (std::vector<LagError>* curve : {&errors.msd, &errors.angular_msd}) {
    for (std::size_t i = 0; i < curve->size(); ++i) {
      (*curve)[i].raw *= overlaps[i];
      (*curve)[i].corrected *= overlaps[i];
    }
  }
  return errors;
}

}  // namespace lab::analysis
