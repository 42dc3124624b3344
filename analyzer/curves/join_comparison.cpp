#include "analyzer/curves/join_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kLongest = 20;     // s
constexpr double kBlockInLags = 5;  // of the longest lag
constexpr std::size_t kLeastBlocks = 8;
constexpr double kLeastWindows = 5;   // across a join
constexpr double kPieceShare = 0.25;  // longest compared lag, in mean pieces

/// Lags of 1, 2, 4, ... frames.
std::vector<int> octaves(double frame_period, double max_lag) {
  std::vector<int> lags{1};
  while (2 * lags.back() * frame_period <= std::min(kLongest, max_lag)) {
    lags.push_back(2 * lags.back());
  }
  return lags;
}

struct Sums {
  double whole = 0;
  double whole_windows = 0;
  double within = 0;
  double within_windows = 0;

  void add(const LagSums& a, const LagSums& b, bool angular, double sign) {
    whole += sign * (angular ? a.a2 : a.r2);
    whole_windows += sign * (angular ? a.angular_windows : a.windows);
    within += sign * (angular ? b.a2 : b.r2);
    within_windows += sign * (angular ? b.angular_windows : b.windows);
  }
  [[nodiscard]] double difference() const {
    return whole / whole_windows - within / within_windows;
  }
};

JoinLag compareLag(const JoinBlocks& data, std::size_t i, bool angular) {
  Sums all;
  for (const JoinBlocks::Block& block : data.blocks) {
    all.add(block.whole[i], block.within[i], angular, 1);
  }
  JoinLag lag;
  lag.tau = data.lags[i] * data.frame_period;
  lag.share = 1 - all.within_windows / all.whole_windows;
  lag.whole = all.whole / all.whole_windows;
  lag.within = all.within / all.within_windows;
  lag.difference = lag.whole - lag.within;
  lag.selection = (kSelection - 1) * std::max(0.0, lag.share) * lag.within;
  double sum = 0;
  double sum2 = 0;
  double n = 0;
  for (const JoinBlocks::Block& block : data.blocks) {
    if (block.whole[i].windows == 0) continue;
    Sums rest = all;
    rest.add(block.whole[i], block.within[i], angular, -1);
    const double difference = rest.difference() - lag.difference;
    sum += difference;
    sum2 += difference * difference;
    n += 1;
  }
  const bool enough =
      n >= static_cast<double>(kLeastBlocks) && lag.share * all.whole_windows >= kLeastWindows;
  lag.sigma = enough ? std::sqrt((n - 1) / n * (sum2 - sum * sum / n)) : kNan;
  // The effect of selection is subtracted and not added to the error, because it is not random.
  const double left = std::max(0.0, std::abs(lag.difference) - lag.selection);
  lag.z = std::copysign(left / lag.sigma, lag.difference);
  return lag;
}

}  // namespace

void JoinBlocks::pool(const JoinBlocks& other) {
  if (lags.empty()) {
    lags = other.lags;
    frame_period = other.frame_period;
  }
  blocks.insert(blocks.end(), other.blocks.begin(), other.blocks.end());
}

JoinAccumulator::JoinAccumulator(double frame_period, double max_lag)
    : blocks_{octaves(frame_period, max_lag), frame_period, {}},
      block_length_(kBlockInLags * blocks_.lags.back() * frame_period),
      whole_(blocks_.lags, frame_period),
      within_(blocks_.lags, frame_period) {}

void JoinAccumulator::add(const Sample& sample) {
  if (whole_.observed() >= block_length_) {
    collect(blocks_);
    whole_ = MsdAccumulator(blocks_.lags, blocks_.frame_period);
    within_ = MsdAccumulator(blocks_.lags, blocks_.frame_period);
  }
  whole_.add(sample);
  Sample piece = sample;
  piece.segment = sample.piece;
  // A change of either one cuts the rotation. Both only increase, so their sum changes too.
  piece.angular_segment = sample.angular_segment + sample.piece;
  within_.add(piece);
}

void JoinAccumulator::collect(JoinBlocks& blocks) const {
  const BlockSums whole = whole_.data().total();
  const BlockSums within = within_.data().total();
  if (whole.lags.size() != blocks.lags.size() || within.lags.size() != blocks.lags.size()) return;
  blocks.blocks.push_back({whole.time, whole.joins, whole.lags, within.lags});
}

JoinBlocks JoinAccumulator::blocks() const {
  JoinBlocks blocks = blocks_;
  collect(blocks);
  return blocks;
}

JoinComparison compareJoins(const JoinBlocks& data) {
  JoinComparison result;
  double time = 0;
  double joins = 0;
  for (const JoinBlocks::Block& block : data.blocks) {
    time += block.time;
    joins += block.joins;
  }
  result.joins = std::llround(joins);
  result.mean_piece = time / (joins + 1);
  result.longest_lag = kPieceShare * result.mean_piece;
  result.max_z = kNan;
  for (std::size_t i = 0; i < data.lags.size() && result.joins > 0; ++i) {
    for (const bool angular : {false, true}) {
      JoinLag lag = compareLag(data, i, angular);
      lag.compared = lag.tau <= result.longest_lag && std::isfinite(lag.z);
      if (lag.compared) {
        ++result.compared;
        if (!(std::abs(lag.z) <= std::abs(result.max_z))) {
          result.max_z = lag.z;
          result.max_z_tau = lag.tau;
          result.max_z_angular = angular;
        }
      }
      (angular ? result.angular_msd : result.msd).push_back(lag);
    }
  }
  return result;
}

}  // namespace lab::analysis
