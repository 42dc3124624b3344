#pragma once

#include <vector>

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// The distribution of the kurtosis <r^4> / <r^2>^2 of overlapping windows over recordings of one
/// length, under a hypothesis. It is simulated because it is skew, its lags are correlated, and
/// blocks of one recording underestimate its error (by 20 % at a hundredth of the recording).
struct KurtosisBootstrap {
  double period = 0;          ///< Frame period, s: slightly shorter than a hold.
  std::vector<double> mean;   ///< Per lag.
  std::vector<double> sigma;  ///< Standard deviation, per lag.
  std::vector<double>
      largest;  ///< The largest |deviation| / sigma over the lags, one per recording, ascending.
};

enum class KurtosisHypothesis { kProgram, kIsotropic };

/// Simulates 300 recordings without noise, of `law` as executed or of Brownian motion in the
/// plane. The same arguments give the same bits. The last few results are cached.
/// @param lags in frames of the recording, ascending, positive and shorter than the
/// recording
/// @param duration s of each recording
[[nodiscard]] const KurtosisBootstrap& kurtosisBootstrap(const ProgramLaw& law,
                                                         KurtosisHypothesis hypothesis,
                                                         const std::vector<int>& lags,
                                                         double duration);

}  // namespace lab::analysis
