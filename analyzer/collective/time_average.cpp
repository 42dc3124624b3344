#include "analyzer/collective/time_average.hpp"

#include <algorithm>
#include <cmath>

#include "analyzer/collective/mean_variance.hpp"
#include "analyzer/curves/statistics.hpp"

namespace lab::collective {
namespace {

constexpr std::size_t kMostBlocks = 64;  // only low frequencies count
constexpr double kFewestEventful = 4;    // blocks that hold the variance

/// Neighbours are averaged until there are at most `most` values; a rest of fewer is left out.
std::vector<double> mergedTo(std::size_t most, std::span<const double> all) {
  const std::size_t each = (all.size() + most - 1) / most;
  if (each <= 1) return {all.begin(), all.end()};
  std::vector<double> merged(all.size() / each, 0.0);
  for (std::size_t i = 0; i < merged.size() * each; ++i) {
    merged[i / each] += all[i] / static_cast<double>(each);
  }
  return merged;
}

}  // namespace

BlockedSums::BlockedSums(std::size_t channels, std::size_t capacity)
    : channels_(channels), capacity_(capacity) {}

std::span<double> BlockedSums::frame() {
  if (in_block_ == 0 && full_ == capacity_) merge();
  const std::size_t begin = full_ * channels_;
  if (sums_.size() < begin + channels_) sums_.resize(begin + channels_, 0.0);
  return {sums_.data() + begin, channels_};
}

void BlockedSums::endFrame() {
  if (++in_block_ < frames_per_block_) return;
  in_block_ = 0;
  ++full_;
}

std::size_t BlockedSums::blocks() const { return full_ + (in_block_ > 0 ? 1 : 0); }

void BlockedSums::merge() {
  for (std::size_t block = 0; block < capacity_ / 2; ++block) {
    for (std::size_t c = 0; c < channels_; ++c) {
      sums_[block * channels_ + c] =
          sums_[2 * block * channels_ + c] + sums_[(2 * block + 1) * channels_ + c];
    }
  }
  full_ = capacity_ / 2;
  frames_per_block_ *= 2;
  std::fill(sums_.begin() + static_cast<std::ptrdiff_t>(full_ * channels_), sums_.end(), 0.0);
}

double BlockedSums::total(std::size_t channel) const {
  double total = 0;
  for (std::size_t block = 0; block < blocks(); ++block) total += sum(block, channel);
  return total;
}

std::vector<double> BlockedSums::column(std::size_t channel) const {
  std::vector<double> column;
  column.reserve(blocks());
  for (std::size_t block = 0; block < blocks(); ++block) column.push_back(sum(block, channel));
  return column;
}

Average averageWithResiduals(double value, std::span<const double> all) {
  Average average;
  average.value = value;
  const std::vector<double> residuals = mergedTo(kMostBlocks, all);
  const auto n = static_cast<double>(residuals.size());
  if (residuals.size() < kFewestBlocks || !std::isfinite(value)) return average;
  double variance = 0;
  double fourth = 0;
  for (const double residual : residuals) {
    variance += residual * residual / n;
    fourth += residual * residual * residual * residual / n;
  }
  if (variance == 0) {
    // What never changed does not say how often it does.
    average.sigma = 0;
    average.independent = n;
    return average;
  }
  const MeanVariance mean = varianceOfMean(residuals);
  if (!(mean.variance > 0)) return average;
  average.independent = std::min(n, variance / mean.variance);
  if (!mean.is_long_enough) {
    average.too_short_by = std::max(1.0, kLongEnough / mean.correlation_times);
    return average;
  }
  average.degrees_of_freedom = mean.degrees_of_freedom;
  average.sigma = std::sqrt(mean.variance);
  // A few blocks of rare events hold all that is known. A normal distribution has n / 3.
  if (n * variance * variance < std::min(kFewestEventful, n / 8) * fourth) return average;
  const double reach = analysis::studentQuantile(average.degrees_of_freedom) * average.sigma;
  average.low = value - reach;
  average.high = value + reach;
  return average;
}

Average averageOf(std::span<const double> numerator, std::span<const double> denominator) {
  double above = 0;
  double below = 0;
  for (std::size_t i = 0; i < numerator.size(); ++i) {
    above += numerator[i];
    below += denominator[i];
  }
  if (!(below > 0)) return {};
  const double value = above / below;
  const double mean = below / static_cast<double>(numerator.size());
  std::vector<double> residuals(numerator.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    residuals[i] = (numerator[i] - value * denominator[i]) / mean;
  }
  return averageWithResiduals(value, residuals);
}

Average averageOf(std::span<const double> series) {
  const std::vector<double> ones(series.size(), 1.0);
  return averageOf(series, ones);
}

Average averageOf(const BlockedSums& sums, std::size_t numerator, std::size_t denominator) {
  return averageOf(sums.column(numerator), sums.column(denominator));
}

}  // namespace lab::collective
