#pragma once

namespace lab::analysis {

/// Two sums of powers of q, accurate also for q close to 1.
struct GeometricSums {
  double plain = 0;     ///< sum_{j=0}^{n-1} q^j
  double weighted = 0;  ///< sum_{j=0}^{n-1} (n - 1 - j) q^j
};

/// @param q in (-1, 1]; n a whole number, at least 0.
[[nodiscard]] GeometricSums geometricSums(double q, double n);

/// The terms with two different holds in the mean square (PhasedNoise) and in the fourth moment
/// (BpKurtosis) of the displacement over a lag window. A lag window covers part of a first hold, n
/// complete holds and part of a last hold.
/// @param first, full_hold, last contributions f_i: of the first hold, of each complete hold, of
///   the last hold
/// @param n number of complete holds
/// @param q correlation factor of adjacent holds
/// @return the sum over i < j of f_i f_j q^(j - i - 1)
[[nodiscard]] double sumOverHoldPairs(double first, double full_hold, double last, double n,
                                      double q);

}  // namespace lab::analysis
