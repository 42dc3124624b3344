#include "analyzer/curves/block_errors.hpp"

#include <cmath>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kNearly = 0.95;

}  // namespace

std::vector<BlockSums> groupBlocks(const BlockData& data, double min_length) {
  std::vector<BlockSums> groups;
  for (const auto& track : data.tracks) {
    const std::size_t first = groups.size();
    BlockSums group;
    for (const BlockSums& block : track) {
      if (group.lags.empty() && group.time == 0) {
        group = block;  // faster than adding to empty sums
      } else {
        group += block;
      }
      if (group.time >= kNearly * min_length) {
        groups.push_back(std::move(group));
        group = BlockSums{};
      }
    }
    if (group.time > 0 && groups.size() > first) {
      groups.back() += group;
    } else if (group.time > 0) {
      groups.push_back(std::move(group));
    }
  }
  return groups;
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

double Replicates::degreesOfFreedom() const {
  double squares = 0;
  for (const double share : shares) {
    squares += share * share;
  }
  return squares > 0 ? 1 / squares - 1 : 0;
}

Replicates jackknife(const std::vector<BlockSums>& groups,
                     const std::function<std::vector<double>(const BlockSums&)>& functions) {
  BlockSums total;
  for (const BlockSums& group : groups) {
    total += group;
  }
  Replicates result;
  result.values = functions(total);
  for (const BlockSums& group : groups) {
    BlockSums rest = total;
    rest -= group;
    result.without.push_back(functions(rest));
    result.shares.push_back(group.time / total.time);
  }
  return result;
}

}  // namespace lab::analysis
