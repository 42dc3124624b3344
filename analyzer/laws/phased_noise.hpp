#pragma once

#include "analyzer/laws/held_noise.hpp"

namespace lab::analysis {

/// Held noise seen by windows that do not begin at a random phase of the hold: by clocks that are
/// locked to each other. Exact at all lags, in a sum of fixed length.
///
/// A window is a rest of a hold, N whole holds and a part of one; their draws are independent, and
/// a hold between two of them turns the later one by chi(epsilon) on average.
class PhasedNoise {
 public:
  explicit PhasedNoise(const HeldNoise& noise);

  /// <|r(t + tau) - r(t)|^2> in m^2 of windows that begin `to_update` (0 to epsilon, s) before an
  /// update. Both ends of that range are a window that begins with a new draw.
  [[nodiscard]] double msd(double tau, double to_update) const;
  /// rad^2.
  [[nodiscard]] double angularMsd(double tau, double to_update) const;
  /// <v(t) . v(t + s)> in m^2/s^2, t the window's begin.
  [[nodiscard]] double velocityCorrelation(double s, double to_update) const;

 private:
  /// How a window falls on the holds, s.
  struct Window {
    double first = 0;
    double holds = 0;  ///< Whole ones.
    double last = 0;
  };
  [[nodiscard]] Window window(double tau, double to_update) const;

  HeldNoise noise_;
  double q_;
  ChebyshevSeries chi_once_;  ///< int_0^t chi: the mean displacement in a hold per speed.
  ChebyshevSeries chi_twice_;
  ChebyshevSeries psi_twice_;
};

/// The mean over frames that fall on `phases` equally spaced phases of the hold, as of a frame rate
/// f with f epsilon = phases / m in lowest terms and clocks that keep it. `first` (s) is from one
/// of the frames to the next update.
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
