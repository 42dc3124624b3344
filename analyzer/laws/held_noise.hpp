#pragma once

#include <memory>

#include "analyzer/laws/chebyshev.hpp"

namespace lab::analysis {

/// The process of the ABP, the noisy ABP and the BP as the robot executes it: once per epsilon the
/// robot draws a pair of wheel speeds and drives an arc with them for the time epsilon (a hold).
/// All results are exact at all lags, for an observation that begins at a uniformly random phase of
/// the hold.
///
/// With chi(t) = <cos(omega t)> and q = chi(epsilon) the velocity correlation is
/// C_v(s) = va^2 g(s) + (1 - s/epsilon)_+ psi(s). For s below epsilon, g is a convolution of chi.
/// For longer s, g is a function of the phase in the hold, the same for all holds, times a power of
/// q. MSD(tau) = 2 int_0^tau (tau - s) C_v(s) ds is therefore a geometric sum over holds.
///
/// g and psi are tabulated on one hold when they are first needed. The tables do not depend on va
/// and are kept, so they are built once for all mean speeds; the diffusivity needs none.
class HeldNoise {
 public:
  /// Constant speed v (m/s), turning rate uniform in [-eta, eta] (rad/s): the ABP.
  static HeldNoise uniformTurning(double v, double eta, double epsilon);

  /// Both wheel speeds independent and uniform in [va - amplitude, va + amplitude] (m/s): the noisy
  /// ABP, and with va = 0 the BP. The amplitude is the paper's V.
  static HeldNoise uniformWheels(double va, double amplitude, double wheel_base, double epsilon);

  /// <|r(t + tau) - r(t)|^2> in m^2.
  [[nodiscard]] double msd(double tau) const;

  /// <(theta(t + tau) - theta(t))^2> in rad^2: 2 D_r (tau - epsilon/3) from tau = epsilon on.
  [[nodiscard]] double angularMsd(double tau) const;

  /// <v(t) . v(t + s)> in m^2/s^2.
  [[nodiscard]] double velocityCorrelation(double s) const;

  /// g(s), the correlation <n(t) . n(t + s)> of the heading direction n.
  [[nodiscard]] double directionCorrelation(double s) const;

  /// lim MSD / (4 tau) in m^2/s; infinite if there is no noise.
  [[nodiscard]] double diffusivity() const;

  /// D_r = epsilon <omega^2> / 2 in rad^2/s: exact.
  [[nodiscard]] double rotationalDiffusivity() const { return 0.5 * shape_.epsilon * omega2_; }

  /// chi(t) = <cos(omega t)> for one draw of the turning rate.
  [[nodiscard]] double chi(double t) const;
  /// <(v - va)^2 cos(omega t)> for one draw of the wheels, m^2/s^2.
  [[nodiscard]] double psi(double t) const;
  [[nodiscard]] double epsilon() const { return shape_.epsilon; }     ///< s.
  [[nodiscard]] double meanSpeed() const { return va_; }              ///< m/s.
  [[nodiscard]] double meanSquareTurning() const { return omega2_; }  ///< <omega^2>, rad^2/s^2.
  /// Number of Chebyshev points that resolve all functions on one hold to full precision.
  [[nodiscard]] int points() const;

 private:
  enum class Noise { kTurning, kWheels };

  /// What the tables depend on.
  struct Shape {
    Noise noise = Noise::kTurning;
    double width = 0;  ///< Scale of the turning rate, 1/s: eta, or amplitude / wheel base.
    double amplitude = 0;
    double epsilon = 0;
    bool operator==(const Shape&) const = default;
  };
  struct Tables;
  struct LazyTables;

  HeldNoise(double va, const Shape& shape);

  [[nodiscard]] Tables makeTables() const;
  [[nodiscard]] const Tables& tables() const;
  /// int_0^tau (tau - s) g(s) ds.
  [[nodiscard]] double meanSpeedPart(double tau) const;
  /// int_0^tau (tau - s) (1 - s/epsilon)_+ psi(s) ds.
  [[nodiscard]] double spreadPart(double tau) const;

  double va_;
  Shape shape_;
  double omega2_;  ///< <omega^2>.
  double q_;
  std::shared_ptr<LazyTables> lazy_;
};

}  // namespace lab::analysis
