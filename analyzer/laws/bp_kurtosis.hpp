#pragma once

#include "analyzer/laws/held_noise.hpp"
#include "analyzer/laws/law.hpp"

namespace lab::analysis {

/// The fourth moment of the displacement of the Brownian particle that the robot executes. Exact at
/// all lags, for a random observation phase and any amplitude of the noise.
///
/// Both wheels draw around zero, so a speed and its opposite are equally likely at the same turning
/// rate. Of <r^4> = <r r r* r*> (r complex) only the terms remain in which every hold occurs two or
/// four times: moments of one hold, and of pairs of holds. The pairs are linked by powers of <exp(2
/// i omega epsilon)>, a geometric sum. The phase is integrated numerically.
///
/// For short holds: 2 + 2 (x - 1 + exp(-x)) / x^2 with x = 4 D_r tau. The robot diffuses along its
/// own axis, whose direction decorrelates after 1/D_r: the kurtosis is 3 (one dimension) at shorter
/// lags and 2 at longer ones.
class BpKurtosis : public DisplacementKurtosis {
 public:
  /// V (m/s), wheel base d (m), epsilon (s), all positive.
  BpKurtosis(double amplitude, double wheel_base, double epsilon);

  /// <r^4> in m^4.
  [[nodiscard]] double fourthMoment(double tau) const;

  [[nodiscard]] double observed(double tau, double offset) const override;

 private:
  /// The fourth moment of a window with these parts, m^4.
  [[nodiscard]] double ofWindow(double first, double holds, double last) const;

  HeldNoise noise_;
  double epsilon_;
  double q2_;  ///< <exp(2 i omega epsilon)>.
  // Moments of the displacement z within a time t of a hold, relative to the heading at its
  // beginning, divided by the leading power of t.
  ChebyshevSeries square_;  ///< <|z|^2> / t^2.
  ChebyshevSeries turned_;  ///< <z^2> / t^2, which is real.
  ChebyshevSeries fourth_;  ///< <|z|^4> / t^4.
};

}  // namespace lab::analysis
