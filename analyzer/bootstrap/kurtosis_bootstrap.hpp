#pragma once

#include <vector>

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// How the kurtosis <r^4> / <r^2>^2 of overlapping windows scatters over recordings of one length
/// under a hypothesis. Its distribution is skew, its lags are correlated and blocks of one
/// recording understate its error (by 20 % at a hundredth of the recording), so that recordings are
/// simulated.
struct KurtosisBootstrap {
  double period = 0;          ///< Between frames, s: a little less than a hold.
  std::vector<double> mean;   ///< One a lag.
  std::vector<double> sigma;  ///< Standard deviation.
  std::vector<double>
      largest;  ///< The largest |deviation| / sigma over the lags, ascending by recording.
};

enum class KurtosisHypothesis { kProgram, kIsotropic };

/// 300 recordings without noise: of the BP `law` as executed, or of Brownian motion in the plane.
/// The same arguments give the same bits; the last few are kept.
/// @param lags in frames of the recording's period, ascending, positive and shorter than the
/// recording
/// @param duration s of each recording
[[nodiscard]] const KurtosisBootstrap& kurtosisBootstrap(const ProgramLaw& law,
                                                         KurtosisHypothesis hypothesis,
                                                         const std::vector<int>& lags,
                                                         double duration);

}  // namespace lab::analysis
