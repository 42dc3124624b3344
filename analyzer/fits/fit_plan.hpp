/// Which lags a fit of a law goes by, and the recordings that give their covariance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/fits/law_hypothesis.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The program's time between changes, s: what its short lags are short against.
[[nodiscard]] double changeTime(const ProgramLaw& law);

/// The longest lag at which a fit still learns something, s.
[[nodiscard]] double longestChange(const ProgramLaw& law);

/// Frames of simulated recordings are so much longer than planned, so that no frame rate locks to
/// the holds: the phase sweeps.
inline constexpr double kDrift = 1.0037;

struct FitOptions {
  /// Share of the MSD that calibration and the wheels' steps may be off at each lag.
  double systematic_floor = 0.002;
  int recordings = 500;    ///< Simulated for the covariance.
  std::uint64_t seed = 1;  ///< Of the first of them.
  /// RTP: fit the tumble time too. It is identified by the bend of the angular MSD at tau_t alone;
  /// programmed and kept by a clock, it is better taken as given.
  bool free_tumble_time = false;
  double longest_lag = 0;  ///< s: longer ones are selected by the outcome; 0: none is.
};

/// The lags of `curves` that a fit uses (indices), and the recordings that give their covariance.
struct FitPlan {
  std::vector<std::size_t> lags;
  double period = 0;    ///< Of the recordings' frames, s.
  double duration = 0;  ///< Of each recording, s.
};
[[nodiscard]] FitPlan planFit(const ProgramLaw& law, const MeasuredCurves& curves,
                              const FitOptions& options);

/// The recordings behind a fit, at the parameters of `law` and the tracker's noise (offsets 4
/// sigma^2 and 2 sigma_theta^2; negative ones count as none).
[[nodiscard]] SimulatedCurves simulateForFit(const ProgramLaw& law, double offset,
                                             double angular_offset, const MeasuredCurves& curves,
                                             const FitPlan& plan, const FitOptions& options);

}  // namespace lab::analysis
