/// The lags of a fit of a law, and the simulated recordings for their covariance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/fits/law_hypothesis.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// Factor on the frame period of simulated recordings, so that the phase of the holds sweeps.
inline constexpr double kDrift = 1.0037;

struct FitOptions {
  /// Relative error of the MSD by calibration and wheel steps, at each lag.
  double systematic_floor = 0.002;
  int recordings = 500;    ///< Number of recordings that are simulated for the covariance.
  std::uint64_t seed = 1;  ///< Seed of the first of them.
  /// Names of durations (Law::fitTimes) that are fitted too. Only the bend of the angular MSD
  /// determines them, so the programmed value, kept by a clock, is more accurate. Names that a law
  /// does not have are ignored.
  std::vector<std::string> free_times;
  double longest_lag = 0;  ///< Longer lags are selected by their outcome, s; 0: none.
};

/// The parameters of the law that a fit frees.
[[nodiscard]] std::vector<FitParameter> freeParameters(const ProgramLaw& law,
                                                       const FitOptions& options);

/// The lags of `curves` that a fit uses (indices), and the parameters of the simulated recordings.
struct FitPlan {
  std::vector<std::size_t> lags;
  double period = 0;    ///< Frame period of the recordings, s.
  double duration = 0;  ///< Of each recording, s.
};
[[nodiscard]] FitPlan planFit(const ProgramLaw& law, const MeasuredCurves& curves,
                              const FitOptions& options);

/// Simulates the recordings for a fit, at the parameters of `law` and the tracker noise (offsets 4
/// sigma^2 and 2 sigma_theta^2; negative ones count as 0).
[[nodiscard]] SimulatedCurves simulateForFit(const ProgramLaw& law, double offset,
                                             double angular_offset, const MeasuredCurves& curves,
                                             const FitPlan& plan, const FitOptions& options);

}  // namespace lab::analysis
