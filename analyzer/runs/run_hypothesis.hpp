#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lab::analysis {

/// A test of a hypothesis.
struct TestResult {
  double statistic = 0;  ///< nan: too little data.
  double p = 0;          ///< Probability of so large a statistic by chance; nan with it.
  double n = 0;          ///< Data behind it.
};

/// A waiting time, or how much of it was seen.
struct WaitingTime {
  double time = 0;  ///< Any unit.
  bool ended = false;
  int track =
      0;  ///< WaitingTime times that follow each other; the track's end cuts the last one off.
};

/// Are the waiting times exponential? The largest distance between the Kaplan-Meier estimate of
/// their distribution and the exponential law of the fitted rate (Lilliefors 1969, with Stephens'
/// correction for n). p from `replicates` simulated sets that are fitted and cut off in the same
/// way, of at most 500 waiting times, beyond which the statistic's distribution does not change.
/// The same seed gives the same p.
[[nodiscard]] TestResult exponentialTest(std::span<const WaitingTime> waiting, std::uint64_t seed,
                                         int replicates = 499);

/// Are angles (rad) uniform on the circle? Kuiper's V with Stephens' (1970) p, good to 1 % from 8
/// angles on.
[[nodiscard]] TestResult kuiperTest(std::span<const double> angles);

/// The same, by the length of the mean direction: Rayleigh's test, the sharpest against one
/// preferred direction (Zar's p).
[[nodiscard]] TestResult rayleighTest(std::span<const double> angles);

/// Are pairs independent? Pearson's correlation, p by the normal law of r sqrt(n - 1).
[[nodiscard]] TestResult correlationTest(std::span<const double> a, std::span<const double> b);

}  // namespace lab::analysis
