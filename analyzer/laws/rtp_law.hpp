#pragma once

#include <complex>

#include "analyzer/laws/turning.hpp"

namespace lab::analysis {

/// Run and tumble: runs at speed v whose durations are exponential with rate gamma, tumbles on the
/// spot of duration tau_t at a constant turning rate, by an angle with the moments of Turning.
/// Exact at all lags in the stationary state.
///
/// A robot that is in a run at time 0 is in a run at s after k whole tumbles if and only if its run
/// clock, which then reads s - k tau_t, has counted k beginnings of tumbles: a Poisson number. Each
/// tumble turns the velocity by z on average, so that C_v(s) = v^2 / (1 + gamma tau_t) Re sum_k z^k
/// p_k(gamma (s - k tau_t)), p_k(x) = exp(-x) x^k/k!, over the k with k tau_t < s. Its double
/// integral is the same sum over E[(N - k - 1)_+] for a Poisson number N. For z = 0 only k = 0
/// remains, which is the paper's eq. 6.
class RtpLaw {
 public:
  /// v in m/s, gamma in 1/s and tau_t in s, both positive.
  RtpLaw(double v, double gamma, double tau_t, const Turning& turning = {});

  [[nodiscard]] double msd(double tau) const;  ///< m^2.

  /// <(theta(t + tau) - theta(t))^2> of the unwrapped heading, rad^2: from tau_t on
  /// proportional to tau - tau_t/3 where <D> = 0, and ballistic at long lags otherwise.
  [[nodiscard]] double angularMsd(double tau) const;

  [[nodiscard]] double velocityCorrelation(double s) const;  ///< m^2/s^2.
  [[nodiscard]] double diffusivity() const;  ///< D_eq6 Re[1 / (1 - z)], m^2/s; infinite for z = 1.
  [[nodiscard]] double persistenceLength() const;  ///< v / gamma Re[1 / (1 - z)], m.
  /// <D> / (1/gamma + tau_t): the drift of the unwrapped heading, rad/s.
  [[nodiscard]] double drift() const { return turning_.mean / (1 / gamma_ + tau_t_); }

 private:
  /// Re sum_k z^k E[(N_k - k - 1)_+], N_k Poisson with mean gamma (tau - k tau_t).
  [[nodiscard]] double doubleIntegral(std::complex<double> z, double tau) const;

  double v_;
  double gamma_;
  double tau_t_;
  Turning turning_;
  double run_share_;  ///< Share of the time in runs.
};

}  // namespace lab::analysis
