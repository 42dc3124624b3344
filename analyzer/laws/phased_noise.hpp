#pragma once

#include "analyzer/laws/held_noise.hpp"

namespace lab::analysis {

/// Held noise observed by windows that begin at a fixed phase of the hold, as if the clocks of
/// camera and robot were locked. Exact at all lags, by a sum of fixed length.
///
/// A window consists of the rest of a hold, N whole holds and a part of one. Their draws are
/// independent. Each hold between two of them multiplies their correlation by chi(epsilon).
class PhasedNoise {
 public:
  explicit PhasedNoise(const HeldNoise& noise);

  /// <|r(t + tau) - r(t)|^2> in m^2 of windows that begin `to_update` (0 to epsilon, s) before an
  /// update. At both ends of that range the window begins with a new draw.
  [[nodiscard]] double msd(double tau, double to_update) const;
  /// rad^2.
  [[nodiscard]] double angularMsd(double tau, double to_update) const;
  /// <v(t) . v(t + s)> in m^2/s^2, t the beginning of the window.
  [[nodiscard]] double velocityCorrelation(double s, double to_update) const;

 private:
  /// The parts of a window, s.
  struct Window {
    double first = 0;
    double holds = 0;  ///< Number of whole holds.
    double last = 0;
  };
  [[nodiscard]] Window window(double tau, double to_update) const;

  HeldNoise noise_;
  double q_;
  ChebyshevSeries chi_once_;  ///< int_0^t chi: the mean displacement in a hold per speed.
  ChebyshevSeries chi_twice_;
  ChebyshevSeries psi_twice_;
};

/// The mean over frames at `phases` equally spaced phases of the hold. This is the case of locked
/// clocks and a frame rate f with f epsilon = phases / m in lowest terms. `first` (s) is the time
/// from one of the frames to the next update.
template <typename OfPhase>
[[nodiscard]] double commensurateMean(double epsilon, int phases, double first,
                                      const OfPhase& of_phase) {
  const double step = epsilon / phases;
  double sum = 0;
  for (int k = 0; k < phases; ++k) {
    double phase = first + k * step;
    while (phase > epsilon) phase -= epsilon;
    sum += of_phase(phase);
  }
  return sum / phases;
}

}  // namespace lab::analysis
