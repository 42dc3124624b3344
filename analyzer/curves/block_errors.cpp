#include "analyzer/curves/block_errors.hpp"

#include <cmath>
#include <utility>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kNearly = 0.95;

}  // namespace

std::vector<BlockGroup> groupBlocks(const BlockData& data, double min_length) {
  std::vector<BlockGroup> groups;
  for (const BlockTrack& track : data.tracks) {
    const std::size_t first = groups.size();
    BlockGroup group{&track, 0, 0, 0};
    for (std::size_t i = 0; i < track.size(); ++i) {
      group.end = i + 1;
      group.time += track[i].time;
      if (group.time >= kNearly * min_length) {
        groups.push_back(group);
        group = {&track, i + 1, i + 1, 0};
      }
    }
    if (group.time > 0 && groups.size() > first) {
      groups.back().end = group.end;
      groups.back().time += group.time;
    } else if (group.time > 0) {
      groups.push_back(group);
    }
  }
  return groups;
}

BlockSums totalOf(const std::vector<BlockGroup>& groups, const BlockData& data, BlockSums total) {
  auto group = groups.begin();
  for (const BlockTrack& track : data.tracks) {
    std::size_t covered = 0;
    for (; group != groups.end() && group->track == &track; ++group) covered = group->end;
    for (; covered < track.size(); ++covered) {
      const BlockSums& left_out = track[covered];
      static_cast<BlockCounts&>(total) -= left_out;
      for (std::size_t i = 0; i < left_out.lags.size(); ++i) total.lags[i] -= left_out.lags[i];
    }
  }
  return total;
}

GroupOmitter::GroupOmitter(const BlockSums& total, std::vector<std::size_t> lags)
    : total_(total), lags_(std::move(lags)), rest_(total) {}

const BlockSums& GroupOmitter::without(const BlockGroup& group) {
  static_cast<BlockCounts&>(rest_) = total_;
  for (const std::size_t i : lags_) rest_.lags[i] = total_.lags[i];
  for (std::size_t b = group.begin; b < group.end; ++b) {
    const BlockSums& block = (*group.track)[b];
    static_cast<BlockCounts&>(rest_) -= block;
    for (const std::size_t i : lags_) rest_.lags[i] -= block.lags[i];
  }
  return rest_;
}

double Replicates::sigmaOf(double value, const std::vector<double>& without_each) const {
  const auto n = static_cast<double>(shares.size());
  if (shares.size() < 2) {
    return units::kNan;
  }
  double mean = n * value;
  for (std::size_t b = 0; b < shares.size(); ++b) {
    mean -= (1 - shares[b]) * without_each[b];
  }
  double variance = 0;
  for (std::size_t b = 0; b < shares.size(); ++b) {
    const double h = 1 / shares[b];
    const double pseudo = h * value - (h - 1) * without_each[b];
    variance += (pseudo - mean) * (pseudo - mean) / (h - 1);
  }
  return std::sqrt(variance / n);
}

std::vector<double> Replicates::column(std::size_t q) const {
  std::vector<double> result;
  result.reserve(without.size());
  for (const auto& row : without) {
    result.push_back(row[q]);
  }
  return result;
}

double degreesOfFreedom(const std::vector<double>& shares) {
  double squares = 0;
  for (const double share : shares) {
    squares += share * share;
  }
  return squares > 0 ? 1 / squares - 1 : 0;
}

Replicates jackknife(const std::vector<BlockGroup>& groups, const BlockSums& total,
                     const std::vector<std::size_t>& lags,
                     const std::function<std::vector<double>(const BlockSums&)>& functions) {
  GroupOmitter omitter(total, lags);
  Replicates result;
  result.values = functions(total);
  for (const BlockGroup& group : groups) {
    result.without.push_back(functions(omitter.without(group)));
    result.shares.push_back(group.time / total.time);
  }
  return result;
}

}  // namespace lab::analysis
