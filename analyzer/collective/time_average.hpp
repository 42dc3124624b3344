/// Time averages of correlated series, with intervals.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/math/units.hpp"

namespace lab::collective {

/// A time average with its error. SI units.
struct Average {
  double value = units::kNan;  ///< nan: nothing was observed
  double sigma = units::kNan;  ///< standard error; nan: the recording is too short
  double low = units::kNan;    ///< 95 % interval; nan: no sigma, or too few events
  double high = units::kNan;
  double independent = 0;         ///< effective number of independent blocks
  double degrees_of_freedom = 0;  ///< of sigma, for Student's t
  /// Without sigma: how many times longer the recording should be, by its fitted correlation time;
  /// nan: unknown.
  double too_short_by = units::kNan;
};

/// Sums of several channels over consecutive blocks of equally many frames. When all blocks are
/// full, neighbours are merged, so that memory is bounded and the block length follows the
/// recording.
class BlockedSums {
 public:
  /// @param capacity number of blocks, even
  BlockedSums(std::size_t channels, std::size_t capacity);

  /// The sums of the block of the current frame: add to them, then call endFrame().
  [[nodiscard]] std::span<double> frame();
  void endFrame();

  [[nodiscard]] std::size_t channels() const { return channels_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Number of blocks; the last one may have fewer frames.
  [[nodiscard]] std::size_t blocks() const;
  [[nodiscard]] std::size_t framesPerBlock() const { return frames_per_block_; }
  [[nodiscard]] double sum(std::size_t block, std::size_t channel) const {
    return sums_[block * channels_ + channel];
  }
  [[nodiscard]] double total(std::size_t channel) const;
  [[nodiscard]] std::vector<double> column(std::size_t channel) const;

 private:
  void merge();

  std::size_t channels_;
  std::size_t capacity_;
  std::size_t frames_per_block_ = 1;
  std::size_t full_ = 0;      ///< complete blocks
  std::size_t in_block_ = 0;  ///< frames in the block after them
  std::vector<double> sums_;
};

/// The mean of numerator / denominator with the sums of consecutive blocks of equal length. Its
/// error is that of the mean of the residuals numerator - value * denominator, which takes their
/// correlation into account (mean_variance.hpp). Before that neighbours are merged until there are
/// at most 64 blocks. The interval is Student's with six degrees of freedom. Recordings of fewer
/// than twelve blocks, or too few correlation times, have no sigma and no interval. Constants and
/// rare events, which happened in fewer than about four blocks, have a sigma and no interval.
[[nodiscard]] Average averageOf(std::span<const double> numerator,
                                std::span<const double> denominator);

/// The mean of a series of equal weights.
[[nodiscard]] Average averageOf(std::span<const double> series);

/// The average of one channel over another one.
[[nodiscard]] Average averageOf(const BlockedSums& sums, std::size_t numerator,
                                std::size_t denominator);

/// An average of which the residuals of each block are known (linearised), such as a function of
/// several sums. The mean of the residuals is 0.
[[nodiscard]] Average averageWithResiduals(double value, std::span<const double> residuals);

}  // namespace lab::collective
