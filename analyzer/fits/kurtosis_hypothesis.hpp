/// Hypothesis tests by the kurtosis of the displacement.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// One lag of the test. All but tau is dimensionless.
struct KurtosisPoint {
  double tau = 0;  ///< [s]
  /// Measured <r^4> / <r^2>^2. Short recordings have a slightly lower mean.
  double kurtosis = 0;
  double sigma = 0;  ///< standard error under the programmed law, from simulated recordings
  double exact = 0;  ///< kurtosis of the programmed law with the tracker's noise
  double z_isotropic =
      0;               ///< [standard deviations] from Brownian motion in the plane; nan: not tested
  double z_exact = 0;  ///< [standard deviations] from the programmed law
};

/// Result of testing one hypothesis on all lags.
struct KurtosisAnswer {
  /// Probability, under the hypothesis, that the largest |z| of all lags is at least the measured
  /// one; nan: not tested.
  double p = 0;
  double tau = 0;         ///< lag of the largest |z| [s]
  bool rejected = false;  ///< p is below 1 %
};

/// Test for Brownian motion by the kurtosis. An MSD of 4 D tau is not sufficient: a robot that
/// diffuses along its own, slowly turning axis has the same MSD.
struct KurtosisTest {
  std::vector<KurtosisPoint> lags;  ///< one per octave, from two holds on
  KurtosisAnswer isotropic;         ///< Brownian motion in the plane; for lags from ten holds on
  KurtosisAnswer exact;             ///< the programmed law of the robot
  std::string text;                 ///< the verdict in words
};

/// Simulates recordings (KurtosisBootstrap), which takes time: only for Depth::kFull.
/// @return nullopt if the law gives no kurtosis, or if no lag is shorter than a fortieth of the
/// recording
[[nodiscard]] std::optional<KurtosisTest> testKurtosis(const ProgramLaw& law,
                                                       const BlockData& data);

}  // namespace lab::analysis
