#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// One lag of the test; dimensionless except tau.
struct KurtosisPoint {
  double tau = 0;  ///< s.
  double kurtosis =
      0;             ///< Measured <r^4> / <r^2>^2; its mean is slightly lower for short recordings.
  double sigma = 0;  ///< Standard error under the programmed law, from simulated recordings.
  double exact = 0;  ///< Expected for the programmed law with the tracker noise.
  double z_isotropic = 0;  ///< Deviation from Brownian motion in the plane; nan: not tested.
  double z_exact = 0;      ///< Deviation from the programmed law. Both in standard deviations.
};

/// Result of testing one hypothesis on all lags.
struct KurtosisAnswer {
  double p = 0;  ///< Probability of such a large largest |z| under the hypothesis; nan: not tested.
  double tau = 0;         ///< Lag of the largest |z|, s.
  bool rejected = false;  ///< p below 1 %.
};

/// Test for Brownian motion by the kurtosis. An MSD of 4 D tau is not sufficient: a robot that
/// diffuses along its own, slowly turning axis has the same MSD.
struct BrownianTest {
  std::vector<KurtosisPoint> lags;  ///< Octaves, from two holds on.
  KurtosisAnswer isotropic;  ///< Brownian motion in the plane; tested for lags from ten holds on.
  KurtosisAnswer exact;      ///< The programmed law of the robot (BpKurtosis).
  std::string text;          ///< The verdict in words.
};

/// Only for the BP, and only if some octave is shorter than a fortieth of the recording; else
/// nullopt. Simulates recordings (KurtosisBootstrap), so it is used for Depth::kFull.
[[nodiscard]] std::optional<BrownianTest> testBrownian(const ProgramLaw& law,
                                                       const BlockData& data);

}  // namespace lab::analysis
