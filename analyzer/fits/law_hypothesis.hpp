#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The curves of block data as input of fits and tests, SI units; nan for lags without windows, and
/// for the angular MSD also for lags whose few windows are not representative.
struct MeasuredCurves {
  std::vector<double> lags;  ///< Mean duration of the windows, s.
  std::vector<double> msd;
  std::vector<double> angular_msd;
  std::vector<double> joined;  ///< Multiple of 4 sigma^2 in each lag: above 1 with joins.
  double frame_period = 0;     ///< s.
  double observed = 0;         ///< Free time, s.
  double tracks = 1;           ///< Number of robots.
  double segments = 1;         ///< Number of pieces, which windows do not leave.
  RecordingGaps gaps;
  double offset = 0;          ///< 4 sigma^2 by the live estimator, m^2.
  double offset_sigma = 0;    ///< Its standard error, m^2.
  double angular_offset = 0;  ///< 2 sigma_theta^2, rad^2.
};

[[nodiscard]] MeasuredCurves measuredCurves(const ProgramLaw& law, const BlockData& data);

/// Test whether the curves follow a law with known parameters, by the Mahalanobis distance on
/// octave lags with the covariance of simulated recordings.
struct LawTest {
  std::vector<double> lags;  ///< s.
  double distance2 = 0;      ///< Squared Mahalanobis distance.
  int freedom = 0;           ///< Number of lags of all curves, less 1 if the speed is free.
  double p_value = 0;        ///< By DistanceDistribution; nan: too few lags.
  double deviate = 0;        ///< The normal deviate of equal probability, in standard deviations.
  double speed = 0;          ///< Free speed over the programmed one; 1: not free, or too far off.
};

enum class TestedLaw {
  kExact,     ///< MSD and angular MSD of the exact law.
  kExactMsd,  ///< Its MSD alone.
  kPaper,     ///< The paper's eq. 4, 5 or 6, MSD alone.
};

/// Simulates recordings at the programmed parameters, as long as the lags need, at octave lags from
/// half of Law::changeTime to at most a 36th of the
/// recording.
[[nodiscard]] SimulatedCurves simulateForTest(const ProgramLaw& law, const MeasuredCurves& curves,
                                              int recordings, std::uint64_t seed);

struct TestOptions {
  double systematic_floor =
      0.002;  ///< Relative systematic error of each lag, independent of the others.
  double speed_tolerance = 0.04;  ///< Of the speed, relative; farther off, it is not free.
  double longest_lag = 0;         ///< Longer lags are selected by their outcome, s; 0: none.
};

[[nodiscard]] LawTest testLaw(TestedLaw tested, const ProgramLaw& law, const MeasuredCurves& curves,
                              const SimulatedCurves& simulated, const TestOptions& options);

}  // namespace lab::analysis
