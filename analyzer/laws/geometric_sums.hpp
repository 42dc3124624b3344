#pragma once

namespace lab::analysis {

/// sum_{j=0}^{n-1} q^j and sum_{j=0}^{n-1} (n - 1 - j) q^j, accurate also for q close to 1.
struct GeometricSums {
  double plain = 0;
  double weighted = 0;
};

/// @param q in (-1, 1]; n a whole number, at least 0.
[[nodiscard]] GeometricSums geometricSums(double q, double n);

/// The sum of f_i f_j q^(j - i - 1) over the pairs i < j of n + 2 values, of which the n between
/// the first and the last one are all equal to `whole`.
[[nodiscard]] double pairsOfChain(double first, double whole, double last, double n, double q);

}  // namespace lab::analysis
