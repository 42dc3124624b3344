#pragma once

namespace lab::analysis {

/// sum_{j=0}^{n-1} q^j and sum_{j=0}^{n-1} (n - 1 - j) q^j, accurate also for q close to 1.
struct GeometricSums {
  double plain = 0;
  double weighted = 0;
};

/// @param q in (-1, 1]; n a whole number, at least 0.
[[nodiscard]] GeometricSums geometricSums(double q, double n);

/// The cross terms of different holds in moments of the displacement over a lag window: in its mean
/// square (PhasedNoise) and its fourth moment (BpKurtosis). A lag window covers part of a first
/// hold, n complete holds and part of a last hold.
/// @param first, full_hold, last contributions f_i of the holds; every complete one has the same
/// @param q correlation factor of adjacent holds
/// @return the sum over i < j of f_i f_j q^(j - i - 1)
[[nodiscard]] double sumOverHoldPairs(double first, double full_hold, double last, double n,
                                      double q);

}  // namespace lab::analysis
