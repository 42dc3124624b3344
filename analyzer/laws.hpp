/// The exact laws of the programs as the robots execute them, and the paper's formulas.
/// docs/theory.md derives them. "The paper" is Paramanick, Pal, Soni and Kumar (README.md).
#pragma once

#include <memory>
#include <numbers>

#include "analyzer/laws/held_noise.hpp"
#include "analyzer/laws/rtp_law.hpp"
#include "robot/dynamics/robot_program.hpp"

namespace lab::analysis {

using dynamics::ProgramKind;

/// A program and the robot's wheel base, which determine the exact law. Only ABP, noisy ABP, BP and
/// RTP have one. wheel_left and wheel_right are always 0 here, so that all programs of constant
/// wheel speeds compare equal.
struct ProgramLaw : dynamics::RobotProgram {
  double wheel_base = 0.075;  ///< d [m]

  bool operator==(const ProgramLaw&) const = default;
};

/// True for the programs that draw wheel speeds and hold them for epsilon.
[[nodiscard]] bool isHeldNoise(ProgramKind kind);

/// Nominal coefficients, exact functions of the programmed parameters; nan if the program has no
/// such coefficient.
[[nodiscard]] double rotationalDiffusivity(const ProgramLaw& law);     ///< D_r, rad^2/s.
[[nodiscard]] double translationalDiffusivity(const ProgramLaw& law);  ///< D_t = epsilon V^2/24.
[[nodiscard]] double meanSpeed(const ProgramLaw& law);  ///< v (ABP, RTP), va (noisy ABP), 0 (BP).

/// The largest wheel speed that the program needs, m/s: |v| + eta d/2 (ABP), |va| + V (noisy
/// ABP, BP), the larger of |v| and largest_turn d / (2 tau_t) (RTP; largest_turn in rad, pi if the
/// robot turns in the shorter direction). Slower wheels saturate, and the robot does not follow the
/// law. nan for programs without a law.
[[nodiscard]] double neededWheelSpeed(const ProgramLaw& law,
                                      double largest_turn = std::numbers::pi);

/// The exact law of what the robot executes, at every lag, averaged over the phase of the hold at
/// which the observation begins.
///
/// Held noise: see HeldNoise. RTP: see RtpLaw; turning angles are uniform on (-180, 180] degrees
/// by default, which makes the paper's eq. 6 exact. If no law exists (standing, constant wheels,
/// epsilon, gamma or tau_t of 0), every value is nan.
class ExactLaw {
 public:
  /// @param turning of an RTP; other programs ignore it.
  explicit ExactLaw(const ProgramLaw& law, const Turning& turning = {});

  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] double msd(double tau) const;                ///< m^2.
  [[nodiscard]] double angularMsd(double tau) const;         ///< rad^2.
  [[nodiscard]] double velocityCorrelation(double s) const;  ///< m^2/s^2.
  [[nodiscard]] double diffusivity() const;                  ///< lim MSD / (4 tau), m^2/s.
  /// The persistence length, m: the integral over the path length l of <cos(change of the heading
  /// after l)>, of ABP and of the runs of RTP; nan for the other programs. The paper's v / D_r is
  /// its limit for small epsilon.
  [[nodiscard]] double persistenceLength() const;
  [[nodiscard]] const ProgramLaw& program() const { return law_; }

 private:
  ProgramLaw law_;
  bool exists_ = false;
  RtpLaw rtp_;
  std::shared_ptr<const HeldNoise> held_;
};

/// The paper's formulas, for comparison: eq. 4 (ABP), eq. 5 (noisy ABP and, with va = 0, BP), eq. 6
/// (RTP); m^2. They neglect epsilon.
[[nodiscard]] double paperMsd(const ProgramLaw& law, double tau);

/// The paper's 2 D_r tau in rad^2; nan for RTP, for which the paper gives none.
[[nodiscard]] double paperAngularMsd(const ProgramLaw& law, double tau);

}  // namespace lab::analysis
