/// The power law of an estimate in the swept keys. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace lab::runner::campaign {

/// A parameter with its 95 % interval.
struct FittedNumber {
  double value = 0;
  double sigma = 0;
  double low95 = 0;
  double high95 = 0;
};

/// One measured point.
struct PowerLawPoint {
  std::vector<double> keys;  ///< positive
  double value = 0;          ///< positive
  double sigma = 0;          ///< its standard error
};

/// value = prefactor * key_1^exponent_1 * key_2^exponent_2 ...
struct PowerLaw {
  FittedNumber prefactor;
  std::vector<FittedNumber> exponents;
  double chi2 = 0;  ///< of the relative residuals
  int freedom = 0;  ///< degrees of freedom of chi2
  double p = 0;     ///< P(chi2 or more), if the power law holds
};

/// Fits a power law by quasi-likelihood: the sum of w (y / mu - 1) x vanishes, with weights by the
/// relative errors. Unlike least squares of logarithms it has no bias from the errors' size.
/// Intervals are Student's t; they are widened by chi2 per degree of freedom if that exceeds 1.
/// @return nothing if a number is not positive, or there are too few or degenerate points
[[nodiscard]] std::optional<PowerLaw> fitPowerLaw(const std::vector<PowerLawPoint>& points);

/// As above for points that share their random numbers, so that their errors are correlated: each
/// set (the runs of one replicate over all points) is fitted alone, and the interval is that of the
/// scatter of the parameters between sets.
/// @return nothing with fewer than three sets, or if a set cannot be fitted
[[nodiscard]] std::optional<PowerLaw> fitPowerLawBySets(
    const std::vector<std::vector<PowerLawPoint>>& sets);

}  // namespace lab::runner::campaign
