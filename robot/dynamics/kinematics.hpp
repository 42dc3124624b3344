#pragma once

#include <stdint.h>

#include <cmath>

namespace lab {
namespace dynamics {

/// Position in the arena frame [m]; heading counter-clockwise from x, not wrapped [rad].
struct Pose {
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// A motion at constant wheel speeds over a fixed time, in the robot's frame at its start. It can
/// be computed once and applied to many steps of equal length.
struct Arc {
  double dx = 0;        ///< Forward [m].
  double dy = 0;        ///< To the left [m].
  double dtheta = 0;    ///< Rotation [rad].
  double cos_turn = 1;  ///< cos(dtheta).
  double sin_turn = 0;  ///< sin(dtheta).
};

/// The exact arc of the unicycle x' = v cos theta, y' = v sin theta, theta' = w over the time dt
/// [s], with the speed v [m/s] and the turning rate w [rad/s]. Exact up to rounding for all turning
/// rates including 0. Inline because the simulation spends most of its time here.
[[nodiscard]] inline Arc makeArcOf(double speed, double turn, double dt) {
  Arc arc;
  arc.dtheta = turn * dt;
  // The chord has the direction of half the turn. This form avoids differences of nearly equal
  // numbers for small turns.
  const double half = arc.dtheta / 2;
  double cosine, sine, sine_over_half;
  if (std::fabs(half) < 0.1) {
    // Taylor series; the first omitted terms are below 0.1^10 / 10! = 3e-17. Also valid for 0.
    const double h2 = half * half;
    const double h4 = h2 * h2;
    sine_over_half =
        1 - h2 * (1 / 6.0) + h4 * (1 / 120.0 - h2 * (1 / 5040.0) + h4 * (1 / 362880.0));
    cosine = 1 - h2 * (1 / 2.0) + h4 * (1 / 24.0 - h2 * (1 / 720.0) + h4 * (1 / 40320.0));
    sine = half * sine_over_half;
  } else {
    cosine = std::cos(half);
    sine = std::sin(half);
    sine_over_half = sine / half;
  }
  const double chord = speed * dt * sine_over_half;
  arc.dx = chord * cosine;
  arc.dy = chord * sine;
  arc.cos_turn = 1 - 2 * sine * sine;
  arc.sin_turn = 2 * sine * cosine;
  return arc;
}

/// The same for wheel speeds [m/s] and a wheel base d [m]: v = (v_l + v_r) / 2 and
/// w = (v_r - v_l) / d (paper, eq. 1).
[[nodiscard]] Arc makeArc(double left, double right, double wheel_base, double dt);

/// Moves a pose along an arc.
[[nodiscard]] Pose apply(const Arc& arc, const Pose& pose);

/// One wheel with its motor driver.
struct WheelModel {
  bool ideal = false;         ///< True: no quantisation by the pulse width modulation.
  double gain = 1;            ///< Actual over commanded speed; not 1 for an uncalibrated wheel.
  int32_t max_um_s = 270000;  ///< Speed at full duty [um/s].
};

/// The actual speed [m/s] of a wheel for the command um_s: clamped, quantised to the nearest duty
/// 0..255 unless ideal, times the gain.
[[nodiscard]] double wheelSpeed(int32_t um_s, const WheelModel& wheel);

}  // namespace dynamics
}  // namespace lab
