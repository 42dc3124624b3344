/// The exact law as functions of the lag, for tables of the theory.
#pragma once

#include <functional>
#include <optional>

#include "analyzer/laws.hpp"

namespace lab::analysis {

/// How the motion is observed.
struct TheoryConditions {
  double exposure = 0;     ///< [s] a pose is the mean over it; 0: an instant
  double sigma = 0;        ///< [m] tracker noise per axis
  double sigma_theta = 0;  ///< [rad] tracker noise of the heading
  /// The angles of turns on the spot; laws without them ignore it.
  Turning turning{};
  /// Of held noise, for camera and robot with locked clocks: windows begin at `phases` equally
  /// spaced phases of the hold, the first one `phase` [s] before an update. Without either, the
  /// phase is random. Needs an exposure of 0.
  std::optional<int> phases{};
  std::optional<double> phase{};
};

/// Functions of the lag [s].
struct TheoryColumns {
  std::function<double(double)> msd;          ///< [m^2]
  std::function<double(double)> angular_msd;  ///< [rad^2]
  std::function<double(double)> correlation;  ///< [m^2/s^2] of the velocity, without noise
  std::function<double(double)> kurtosis;     ///< <r^4> / <r^2>^2; empty: not known
};

/// Every function returns nan for a program without a law.
[[nodiscard]] TheoryColumns theoryColumns(const ProgramLaw& law,
                                          const TheoryConditions& conditions);

}  // namespace lab::analysis
