/// The variance of the mean of a correlated series.
#pragma once

#include <cstddef>
#include <span>

#include "common/math/units.hpp"

namespace lab::collective {

/// What a series without its mean says about the error of that mean.
struct MeanVariance {
  double variance = units::kNan;           ///< of the mean; nan: fewer than kFewestBlocks values
  double degrees_of_freedom = 0;           ///< of the variance, for Student's t
  double correlation_times = units::kNan;  ///< length of the series in fitted correlation times
  bool is_long_enough = false;             ///< else an interval from `variance` is too short
};

/// Fewest values with a variance.
inline constexpr std::size_t kFewestBlocks = 12;

/// From this length on [correlation times] intervals have their probability.
inline constexpr double kLongEnough = 20;

/// The variance of the mean is the spectrum at frequency 0. It is estimated by the mean power of
/// the six cosines of lowest frequency, 1/2 to 3 periods in the series; they do not contain the
/// mean. With six powers the mean over its error has Student's distribution with six degrees of
/// freedom if the spectrum is flat at these frequencies, whatever it is above (Muller, J.
/// Econometrics 141, 1331, 2007; Lazarus, Lewis, Stock and Watson, J. Bus. Econ. Stat. 36, 541,
/// 2018). The number is fixed: one that follows the data is large when slow fluctuations happen to
/// be small.
///
/// If the correlation time is more than some percent of the series, the spectrum falls between
/// frequency 0 and the cosines. A Lorentzian and a constant are fitted to up to 32 powers
/// (Whittle's likelihood on a grid, mean over the posterior); the variance is multiplied by the
/// ratio of the variance of the mean to the mean power of the six cosines. A series is not long
/// enough if the ratio exceeds 2.5.
[[nodiscard]] MeanVariance varianceOfMean(std::span<const double> residuals);

}  // namespace lab::collective
