#include "analyzer/curves/lag_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "analyzer/laws/numerics.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kBlocksPerLag = 5;
constexpr std::size_t kEnoughBlocks = 12;

double mean(double sum, std::uint32_t n) { return n > 0 ? sum / n : units::kNan; }

/// One group of blocks in the jackknife (Replicates::sigmaOf()).
struct Weights {
  double kept = 0;     ///< 1 - share of the group
  double inverse = 0;  ///< h - 1 = 1 / share - 1
};

/// Replicates::sigmaOf() of one mean in a single pass: with u = without - value and U the sum of
/// kept * u, pseudo-value less mean is U - (h - 1) u.
class JackknifeSums {
 public:
  void add(double difference, const Weights& weights) {
    kept_ += weights.kept * difference;
    plain_ += difference;
    squares_ += weights.inverse * difference * difference;
  }

  /// @param inverses sum of 1 / (h - 1)
  [[nodiscard]] double sigma(std::size_t groups, double inverses) const {
    const double variance = kept_ * (kept_ * inverses - 2 * plain_) + squares_;
    return std::sqrt(std::max(variance, 0.0) / static_cast<double>(groups));
  }

 private:
  double kept_ = 0;
  double plain_ = 0;
  double squares_ = 0;
};

/// Both curves at one lag.
struct LagSlot {
  std::size_t lag = 0;
  double factor = 0;  ///< frames - 2
  double msd = 0;     ///< of all groups
  double angular_msd = 0;
  JackknifeSums raw;
  JackknifeSums corrected;
  JackknifeSums angular_raw;
  JackknifeSums angular_corrected;
};

/// Groups of blocks of one length, and the lags that use them.
struct Level {
  std::vector<BlockGroup> groups;
  BlockSums total;  ///< of the groups
  std::vector<LagSlot> slots;
};

class Jackknife {
 public:
  Jackknife(const BlockData& data, const Estimator& estimator, double offset)
      : data_(data), estimator_(estimator), offset_(offset), own_(data.lags.size()) {}

  void run(Level& level) {
    const BlockSums& total = level.total;
    const LagNoise all_noise = LagNoise::of(estimator_, total, offset_);
    for (LagSlot& slot : level.slots) {
      const LagSums& all = total.lags[slot.lag];
      slot.msd = mean(all.r2, all.windows);
      slot.angular_msd = mean(all.a2, all.angular_windows);
    }
    GroupOmitter omitter(total, estimator_.neededLags());
    for (const BlockGroup& group : level.groups) {
      const double share = group.time / total.time;
      const Weights weights{1 - share, 1 / share - 1};
      const LagNoise noise = LagNoise::of(estimator_, omitter.without(group), offset_);
      const double position = noise.position - all_noise.position;
      const double joined = (noise.position * noise.joins - all_noise.position * all_noise.joins) *
                            data_.frame_period;
      const double heading = noise.heading - all_noise.heading;
      const std::vector<LagSums>& own = sumsOf(group, level.slots);
      for (LagSlot& slot : level.slots) {
        const LagSums& all = total.lags[slot.lag];
        const LagSums& out = own[slot.lag];
        const double msd = mean(all.r2 - out.r2, all.windows - out.windows) - slot.msd;
        const double angular =
            mean(all.a2 - out.a2, all.angular_windows - out.angular_windows) - slot.angular_msd;
        slot.raw.add(msd, weights);
        slot.corrected.add(msd - (position + joined * slot.factor), weights);
        slot.angular_raw.add(angular, weights);
        slot.angular_corrected.add(angular - heading, weights);
      }
    }
  }

 private:
  /// The sums of a group at the lags of the slots.
  const std::vector<LagSums>& sumsOf(const BlockGroup& group, const std::vector<LagSlot>& slots) {
    if (group.end == group.begin + 1) return (*group.track)[group.begin].lags;
    for (const LagSlot& slot : slots) own_[slot.lag] = LagSums{};
    for (std::size_t b = group.begin; b < group.end; ++b) {
      const std::vector<LagSums>& lags = (*group.track)[b].lags;
      for (const LagSlot& slot : slots) own_[slot.lag] += lags[slot.lag];
    }
    return own_;
  }

  const BlockData& data_;
  const Estimator& estimator_;
  double offset_;
  std::vector<LagSums> own_;
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
  for (std::size_t i = 0; i < times.size(); ++i) {
    double length = native;
    while (length < kBlocksPerLag * times[i]) length *= 2;
    const bool enough = level(length).groups.size() >= kEnoughBlocks;
    // Windows extend by the lag into the block before, so neighbouring blocks are correlated.
    const double overlap = enough ? 1 / std::sqrt(1 - times[i] / (4 * length)) : 1;
    while (level(length).groups.size() < kEnoughBlocks && length > native) length /= 2;
    LagSlot slot;
    slot.lag = i;
    slot.factor = data.lags[i] - 2.0;
    level(length).slots.push_back(slot);
    errors.msd.push_back({overlap, overlap, 0, enough});
    errors.angular_msd.push_back({overlap, overlap, 0, enough});
  }
  Jackknife jackknife(data, estimator, offset);
  for (auto& [length, one] : levels) {
    if (one.slots.empty()) continue;
    one.total = totalOf(one.groups, data, estimator.total());
    jackknife.run(one);
    std::vector<double> shares;
    double inverses = 0;
    for (const BlockGroup& group : one.groups) {
      const double share = group.time / one.total.time;
      shares.push_back(share);
      inverses += share / (1 - share);
    }
    const double freedom = degreesOfFreedom(shares);
    for (const LagSlot& slot : one.slots) {
      const auto fill = [&](LagError& error, const JackknifeSums& raw,
                            const JackknifeSums& corrected) {
        const std::size_t groups = shares.size();
        error.raw *= groups < 2 ? units::kNan : raw.sigma(groups, inverses);
        error.corrected *= groups < 2 ? units::kNan : corrected.sigma(groups, inverses);
        error.freedom = freedom;
      };
      fill(errors.msd[slot.lag], slot.raw, slot.corrected);
      fill(errors.angular_msd[slot.lag], slot.angular_raw, slot.angular_corrected);
    }
  }
  return errors;
}

}  // namespace lab::analysis
