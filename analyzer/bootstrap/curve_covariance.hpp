#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/recording_gaps.hpp"
#include "analyzer/bootstrap/simulated_recording.hpp"

namespace lab::analysis {

/// MSD and angular MSD of a recording at lags of whole frames, with the selection of overlapping
/// windows of MsdAccumulator (window_choice.hpp). The result is [MSD(lags), angular MSD(lags)]; nan
/// if the recording is shorter than the lag.
[[nodiscard]] std::vector<double> recordingCurves(const RecordingPoses& poses,
                                                  const std::vector<int>& lags);

/// The same, with the selection of windows of a measured recording.
/// @param measured the lags in frames of that recording
/// @param every number of its frames per frame of `poses`
/// @param stretches of the frames of `poses`; empty: no gaps
/// @param tapered if not nullptr, gets the same curves with the windows weighted by a taper
[[nodiscard]] std::vector<double> recordingCurves(const RecordingPoses& poses,
                                                  const std::vector<int>& lags,
                                                  const std::vector<int>& measured, double every,
                                                  const RecordingStretches& stretches,
                                                  std::vector<double>* tapered = nullptr);

/// Curves of many simulated recordings of one program (parametric bootstrap). Their scatter is the
/// error of a measured curve, their covariance that of its lags.
struct SimulatedCurves {
  std::vector<double> lags;  ///< s, ascending.
  double duration = 0;       ///< Observed time of each recording, s.
  int recordings = 0;
  bool cut = false;  ///< They have cuts like the measured recording.
  /// One row [MSD(lags), angular MSD(lags)] per recording, SI units; nan: not needed, no windows.
  std::vector<double> values;
  /// The same from windows that are weighted by a taper; empty: not needed. In curves without it,
  /// the windows at the ends differ between lags, which adds a variance proportional to 1/T^2. It
  /// dominates where fluctuations of several lags nearly cancel.
  std::vector<double> tapered;
  std::vector<double>
      law;  ///< The exact law at the lags with the offsets of the noise, same order.

  [[nodiscard]] double value(int recording, std::size_t column) const {
    return values[static_cast<std::size_t>(recording) * 2 * lags.size() + column];
  }
  [[nodiscard]] double taperedValue(int recording, std::size_t column) const {
    return tapered[static_cast<std::size_t>(recording) * 2 * lags.size() + column];
  }
};

struct BootstrapPlan {
  ProgramLaw law;
  double sigma = 0;        ///< Tracker noise per axis, m.
  double sigma_theta = 0;  ///< rad.
  double period =
      0;  ///< Frame period of the simulated recordings, s: a fraction of the shortest lag.
  double frame_period =
      0;  ///< Frame period of the measured recording, s, whose selection of windows is used.
  RecordingGaps gaps;        ///< Gaps of the measured recording.
  std::vector<double> lags;  ///< s; rounded to whole periods.
  /// By lag, whether the angular MSD is needed: gaps may leave no window for it. Empty: everywhere.
  std::vector<bool> angular;
  double duration = 0;  ///< Of each recording, s.
  bool taper = false;   ///< Whether tapered curves are needed.
  int recordings = 500;
  std::uint64_t seed =
      1;  ///< Recording i has the seed `seed` + i, so all plans use the same random numbers.
};

[[nodiscard]] SimulatedCurves simulateCurves(const BootstrapPlan& plan);

/// The factor by which the standard error of a mean over overlapping windows of lag tau shrinks
/// from one simulated recording to `observed` seconds in `segments` pieces, (no window crosses
/// pieces): the windows cover observed - segments * tau, or, if the simulated recordings have cuts,
/// the same share as theirs. The covariance is proportional to 1/T if the recording is long
/// compared with the lag and the memory. The factor is 1 for recordings as long as the observed
/// ones.
[[nodiscard]] double errorScale(const SimulatedCurves& recordings, double observed, double segments,
                                double tau);

/// The same factor for tapered curves.
[[nodiscard]] double taperedScale(const SimulatedCurves& recordings, double observed,
                                  double segments, double tau);

/// The standard error of one column relative to the law, interpolated in log lag between the
/// simulated lags, for `observed` seconds in `segments` pieces; nan outside them.
[[nodiscard]] double relativeError(const SimulatedCurves& curves, bool angular, double tau,
                                   double observed, double segments);

}  // namespace lab::analysis
