#pragma once

namespace lab::analysis {

/// sum_{j=0}^{n-1} q^j and sum_{j=0}^{n-1} (n - 1 - j) q^j, also where q is close to 1.
struct GeometricSums {
  double plain = 0;
  double weighted = 0;
};

/// @param q in (-1, 1]; n a whole number from 0.
[[nodiscard]] GeometricSums geometricSums(double q, double n);

/// The sum over the pairs i < j of a chain of n + 2 links of f_i f_j q^(j - i - 1), in which the
/// links between the first and the last one are equal.
[[nodiscard]] double pairsOfChain(double first, double whole, double last, double n, double q);

}  // namespace lab::analysis
