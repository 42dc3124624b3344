#pragma once

#include "analyzer/laws/held_noise.hpp"

namespace lab::analysis {

/// The fourth moment of the Brownian particle's displacement as the robot executes it, exact at all
/// lags for a random observation phase and any amplitude of the noise.
///
/// Both wheels draw around zero, so that the speed of a draw is as likely as its opposite at the
/// same turning rate: of <r^4> = <r r r* r*> (r complex) only the terms remain in which every hold
/// occurs two or four times. What is left are moments of one hold and pairs of holds, the latter
/// chained by <exp(2 i omega epsilon)>, a geometric sum; the phase is integrated numerically.
///
/// For short holds: 2 + 2 (x - 1 + exp(-x)) / x^2 with x = 4 D_r tau. The robot diffuses along its
/// own axis, which has forgotten its direction after 1/D_r: 3 as in one dimension below, 2 above.
class BpKurtosis {
 public:
  /// V (m/s), wheel base d (m), epsilon (s), all positive.
  BpKurtosis(double amplitude, double wheel_base, double epsilon);

  /// <r^4> in m^4.
  [[nodiscard]] double fourthMoment(double tau) const;

  /// <r^4> / <r^2>^2; tau > 0.
  [[nodiscard]] double kurtosis(double tau) const { return observed(tau, 0); }

  /// The same as seen with noise that adds `offset` (4 sigma^2, m^2) to the MSD.
  [[nodiscard]] double observed(double tau, double offset) const;

 private:
  /// Sum over the terms of one phase.
  [[nodiscard]] double ofWindow(double first, double holds, double last) const;

  HeldNoise noise_;
  double epsilon_;
  double q2_;  ///< <exp(2 i omega epsilon)>.
  // Moments of the displacement z in a part t of a hold, relative to the heading at its begin, over
  // the power of t that they begin with.
  ChebyshevSeries square_;  ///< <|z|^2> / t^2.
  ChebyshevSeries turned_;  ///< <z^2> / t^2, which is real.
  ChebyshevSeries fourth_;  ///< <|z|^4> / t^4.
};

}  // namespace lab::analysis
