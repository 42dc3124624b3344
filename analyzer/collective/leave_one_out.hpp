/// Averages of functions of several sums.
#pragma once

#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "analyzer/collective/time_average.hpp"

namespace lab::collective {

/// The value of a function of the sums of all blocks. Its residual in a block is (blocks - 1) times
/// the change of the value without this block (jackknife).
/// @param function std::span<const double> with a sum per channel -> double; nan: not defined
template <class Function>
[[nodiscard]] Average averageOfFunction(const BlockedSums& sums, Function function) {
  std::vector<double> totals(sums.channels());
  for (std::size_t c = 0; c < totals.size(); ++c) totals[c] = sums.total(c);
  const double value = function(std::span<const double>(totals));
  if (!std::isfinite(value)) return {};
  const std::size_t blocks = sums.blocks();
  std::vector<double> residuals(blocks);
  std::vector<double> without(totals.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t c = 0; c < totals.size(); ++c) without[c] = totals[c] - sums.sum(b, c);
    residuals[b] =
        static_cast<double>(blocks - 1) * (value - function(std::span<const double>(without)));
    if (!std::isfinite(residuals[b])) return {value};
  }
  const double mean =
      std::accumulate(residuals.begin(), residuals.end(), 0.0) / static_cast<double>(blocks);
  for (double& residual : residuals) residual -= mean;
  return averageWithResiduals(value, residuals);
}

}  // namespace lab::collective
