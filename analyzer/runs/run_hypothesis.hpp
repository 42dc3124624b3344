#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lab::analysis {

/// The result of a hypothesis test.
struct TestResult {
  double statistic = 0;  ///< nan: too little data.
  double p = 0;          ///< Probability of such a large statistic by chance; nan: too little data.
  double n = 0;          ///< Number of data.
};

/// A waiting time, or the observed part of it.
struct WaitingTime {
  double time = 0;  ///< Any unit.
  bool ended = false;
  int track =
      0;  ///< WaitingTime times that follow each other; the track's end cuts the last one off.
};

/// Tests whether waiting times are exponential, by the largest distance between the Kaplan-Meier
/// estimate of their distribution and the exponential law of the fitted rate (Lilliefors 1969, with
/// Stephens' correction for n). p is from `replicates` simulated sets that are fitted and cut off
/// in the same way, with at most 500 waiting times (the distribution of the statistic does not
/// change beyond). The same seed gives the same p.
[[nodiscard]] TestResult exponentialTest(std::span<const WaitingTime> waiting, std::uint64_t seed,
                                         int replicates = 499);

/// Tests whether angles (rad) are uniform on the circle, by Kuiper's V with Stephens' (1970) p,
/// accurate to 1 % from 8 angles on.
[[nodiscard]] TestResult kuiperTest(std::span<const double> angles);

/// The same by the length of the mean direction: Rayleigh's test, the most powerful one against a
/// single preferred direction (p as in the textbook Biostatistical Analysis).
[[nodiscard]] TestResult rayleighTest(std::span<const double> angles);

/// Tests whether pairs are independent, by Pearson's correlation; p by the normal distribution of r
/// sqrt(n - 1).
[[nodiscard]] TestResult correlationTest(std::span<const double> a, std::span<const double> b);

}  // namespace lab::analysis
