#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/recording_gaps.hpp"
#include "analyzer/bootstrap/simulated_recording.hpp"

namespace lab::analysis {

/// MSD and angular MSD of a recording at lags of whole frames: overlapping windows, chosen as
/// MsdAccumulator chooses them (window_choice.hpp). The result is [MSD(lags), angular MSD(lags)],
/// nan where the recording is shorter than the lag.
[[nodiscard]] std::vector<double> recordingCurves(const RecordingPoses& poses,
                                                  const std::vector<int>& lags);

/// The same, chosen as the windows of a measured recording are.
/// @param measured the lags there [frames of that recording]
/// @param every of its frames, to one of `poses`
/// @param stretches of the frames of `poses`; empty: all are there
[[nodiscard]] std::vector<double> recordingCurves(const RecordingPoses& poses,
                                                  const std::vector<int>& lags,
                                                  const std::vector<int>& measured, double every,
                                                  const RecordingStretches& stretches);

/// Curves of many simulated recordings of one program, the parametric bootstrap: their scatter is
/// the error of a measured curve, their covariance how the lags err together.
struct SimulatedCurves {
  std::vector<double> lags;  ///< s, ascending.
  double duration = 0;       ///< Of each recording, as far as it counts as observed, s.
  int recordings = 0;
  bool cut = false;            ///< They lack what the cuts of the measured recording take.
  std::vector<double> values;  ///< recordings rows of [MSD(lags), angular MSD(lags)], SI units.
  std::vector<double> law;     ///< The exact law at the lags with the noise's offsets, same order.

  [[nodiscard]] double value(int recording, std::size_t column) const {
    return values[static_cast<std::size_t>(recording) * 2 * lags.size() + column];
  }
};

struct BootstrapPlan {
  ProgramLaw law;
  double sigma = 0;          ///< Tracker noise per axis, m.
  double sigma_theta = 0;    ///< rad.
  double period = 0;         ///< Of the recordings' frames, s: a part of the shortest lag.
  double frame_period = 0;   ///< Of the measured recording, s, whose choice of windows they follow,
  RecordingGaps gaps;        ///< and what it lacks.
  std::vector<double> lags;  ///< s; taken at the nearest whole number of periods.
  double duration = 0;       ///< Of each recording, s.
  int recordings = 500;
  std::uint64_t seed =
      1;  ///< Recording i has seed + i: the same recordings for every plan, in effect.
};

[[nodiscard]] SimulatedCurves simulateCurves(const BootstrapPlan& plan);

/// The factor by which the standard error of a mean over overlapping windows of lag tau shrinks
/// from one simulated recording to `observed` seconds in `segments` pieces, which no window leaves:
/// the windows cover observed - segments * tau, or as much of it as those of recordings with cuts.
/// The covariance goes as 1/T once the recording is long against lag and memory; for recordings as
/// long as the observed ones no scaling is needed and the factor is 1.
[[nodiscard]] double errorScale(const SimulatedCurves& recordings, double observed, double segments,
                                double tau);

/// The standard error of one column relative to the law, interpolated in log lag between the
/// simulated lags, for `observed` seconds in `segments` pieces; nan outside them.
[[nodiscard]] double relativeError(const SimulatedCurves& curves, bool angular, double tau,
                                   double observed, double segments);

}  // namespace lab::analysis
