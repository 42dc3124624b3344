#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"
#include "analyzer/laws.hpp"

namespace lab::analysis {

/// One lag of the test; pure numbers but for tau.
struct KurtosisPoint {
  double tau = 0;  ///< s.
  double kurtosis =
      0;             ///< <r^4> / <r^2>^2 as measured; a short recording's mean is a little lower.
  double sigma = 0;  ///< Standard error under the programmed law, from simulated recordings.
  double exact = 0;  ///< Expected of the programmed law as seen with the tracker's noise.
  double z_isotropic = 0;  ///< Deviation from Brownian motion in the plane; nan: not asked.
  double z_exact = 0;      ///< Deviation from the programmed law, both in standard deviations.
};

/// One question put to all lags at a time.
struct KurtosisAnswer {
  double p = 0;    ///< Chance of a largest |z| this large under the hypothesis; nan: not asked.
  double tau = 0;  ///< Where that is, s.
  bool rejected = false;  ///< p below 1 %.
};

/// Is this Brownian motion? An MSD that grows as 4 D tau does not say so: a robot that diffuses
/// along its own, slowly turning axis has the same one.
struct BrownianTest {
  std::vector<KurtosisPoint> lags;  ///< Octaves, from two holds on.
  KurtosisAnswer isotropic;         ///< Brownian motion in the plane; asked from ten holds on.
  KurtosisAnswer exact;             ///< The programmed law of the robot (BpKurtosis).
  std::string text;                 ///< The verdict in words.
};

/// For the BP alone, and where some octave is shorter than a fortieth of the recording; else
/// nothing. Simulates recordings (KurtosisBootstrap), so for Depth::kFull.
[[nodiscard]] std::optional<BrownianTest> testBrownian(const ProgramLaw& law,
                                                       const BlockData& data);

}  // namespace lab::analysis
