#pragma once

#include <cstddef>
#include <vector>

#include "analyzer/curves/block_errors.hpp"
#include "analyzer/curves/estimates.hpp"

namespace lab::analysis {

/// The noise of the tracker in the MSD and the angular MSD.
struct LagNoise {
  double position = 0;  ///< m^2
  double heading = 0;   ///< rad^2
  double joins = 0;     ///< Number of removed reversals per second.

  /// @param offset m^2, used if the sums do not determine the noise of the positions
  [[nodiscard]] static LagNoise of(const Estimator& estimator, const BlockSums& sums,
                                   double offset);

  /// The noise in the MSD of a lag. Windows across joins have more: the positions on both sides of
  /// a join are noisy too, and shared by these windows.
  [[nodiscard]] double inMsd(int lag, double frame_period) const {
    return position * (1 + joins * frame_period * (lag - 2.0));
  }
};

/// The standard error of the mean of one lag, by the jackknife over blocks.
struct LagError {
  double raw = 0;        ///< Of the mean.
  double corrected = 0;  ///< Of the mean, less the noise.
  double freedom = 0;    ///< Degrees of freedom of both.
  bool enough = false;   ///< Enough blocks, each long enough.
};

struct LagErrors {
  std::vector<LagError> msd;  ///< By lag.
  std::vector<LagError> angular_msd;
};

/// The errors of all lags, each from blocks that are long enough for it.
/// @param times the lags in s
/// @param offset as of LagNoise::of()
[[nodiscard]] LagErrors lagErrors(const BlockData& data, const Estimator& estimator,
                                  const std::vector<double>& times, double offset);

}  // namespace lab::analysis
