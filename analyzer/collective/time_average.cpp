#include "analyzer/collective/time_average.hpp"

#include <algorithm>
#include <cmath>

#include "analyzer/curves/statistics.hpp"

namespace lab::collective {
namespace {

constexpr double kWindowFactor = 1.5;  // S of Wolff 2004, eq. 52
constexpr std::size_t kFewestBlocks = 8;
constexpr double kFewestFreedom = 4;
// More blocks hide slow fluctuations of small amplitude, such as those of the density, behind fast
// ones: the window would end too early.
constexpr std::size_t kMostBlocks = 64;

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

double covariance(std::span<const double> residuals, std::size_t lag) {
  double sum = 0;
  const std::size_t count = residuals.size() - lag;
  for (std::size_t i = 0; i < count; ++i) sum += residuals[i] * residuals[i + lag];
  return sum / static_cast<double>(count);
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
  const std::size_t blocks = residuals.size();
  if (blocks < kFewestBlocks || !std::isfinite(value)) return average;
  const auto n = static_cast<double>(blocks);
  const double variance = covariance(residuals, 0);
  if (!(variance > 0)) {
    // A constant has no error; one that is not known has no interval.
    if (variance == 0) {
      average.sigma = 0;
      average.low = average.high = value;
      average.independent = average.degrees_of_freedom = n;
    }
    return average;
  }
  double sum = variance;  // of the covariances over all lags within the window
  std::size_t window = 0;
  for (std::size_t lag = 1; lag < blocks / 2; ++lag) {
    sum += 2 * covariance(residuals, lag);
    window = lag;
    const double time = sum / (2 * variance);  // integrated correlation time, in blocks
    const double tau =
        time <= 0.5 ? 1e-9 : kWindowFactor / std::log((2 * time + 1) / (2 * time - 1));
    const auto t = static_cast<double>(lag);
    if (std::exp(-t / tau) - tau / std::sqrt(t * n) < 0) break;
  }
  if (sum <= 0) sum = variance;
  const double width = 2 * static_cast<double>(window) + 1;
  sum *= 1 + width / n;
  average.degrees_of_freedom = n / width;
  average.independent = std::min(n, n * variance / sum);
  if (average.degrees_of_freedom < kFewestFreedom) return average;
  average.sigma = std::sqrt(sum / n);
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
