#pragma once

#include <string>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"
#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The curves of block data as fits and tests take them, SI units; nan for a lag without windows.
struct MeasuredCurves {
  std::vector<double> lags;  ///< Mean duration of the windows, s.
  std::vector<double> msd;
  std::vector<double> angular_msd;
  std::vector<double> joined;  ///< Share of 4 sigma^2 in each lag: above 1 across joins.
  double frame_period = 0;     ///< s.
  double observed = 0;         ///< Free time, s.
  double tracks = 1;           ///< Of so many robots,
  double segments = 1;         ///< in so many pieces that no window leaves.
  RecordingGaps gaps;
  double offset = 0;          ///< 4 sigma^2 as the live estimator has it, m^2.
  double angular_offset = 0;  ///< 2 sigma_theta^2, rad^2.
};

[[nodiscard]] MeasuredCurves measuredCurves(const ProgramLaw& law, const BlockData& data);

/// Whether the curves are those of a law whose parameters are known: the Mahalanobis distance on
/// octave lags with the covariance of simulated recordings.
struct LawTest {
  std::vector<double> lags;  ///< s.
  double distance2 = 0;      ///< Squared.
  int freedom = 0;           ///< Lags of all curves, less 1 where the speed is free.
  double p_value = 0;        ///< By Hotelling's distribution; nan: too few lags.
  double deviate = 0;        ///< The normal deviate as improbable as that, in standard deviations.
  double speed = 0;          ///< Free speed over the programmed one; 1: not free.
};

enum class TestedLaw {
  kExact,     ///< MSD and angular MSD of the exact law.
  kExactMsd,  ///< Its MSD alone.
  kPaper,     ///< The paper's eq. 4, 5 or 6, MSD alone.
};

/// Octave lags from about epsilon/2 (RTP: half the shorter of 1/gamma and tau_t) to the recording's
/// 36th part at most, of those measured; recordings at the programmed parameters as long as the
/// lags need. The speed (v, va) is free within `tolerance`, as it may be a matter of calibration;
/// else as programmed.
[[nodiscard]] SimulatedCurves simulateForTest(const ProgramLaw& law, const MeasuredCurves& curves,
                                              int recordings, std::uint64_t seed);

struct TestOptions {
  double systematic_floor = 0.002;  ///< Share of the law; of each lag by itself.
  double speed_tolerance = 0.05;
  double longest_lag = 0;  ///< s: longer ones are selected by the outcome; 0: none is.
};

[[nodiscard]] LawTest testLaw(TestedLaw tested, const ProgramLaw& law, const MeasuredCurves& curves,
                              const SimulatedCurves& simulated, const TestOptions& options);

}  // namespace lab::analysis
