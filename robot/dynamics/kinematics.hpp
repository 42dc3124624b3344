#pragma once

#include <stdint.h>

#include <cmath>

namespace lab {
namespace dynamics {

/// Where a robot is: metres in the arena frame, heading counter-clockwise from x in rad
/// (unwrapped).
struct Pose {
  double x = 0;
  double y = 0;
  double theta = 0;
};

/// A motion at constant wheel speeds over a fixed time, in the frame of the robot at its start.
/// Computed once and applied to as many equal steps as the wheel speeds last.
struct Arc {
  double dx = 0;        ///< Forward, m.
  double dy = 0;        ///< To the left, m.
  double dtheta = 0;    ///< rad.
  double cos_turn = 1;  ///< cos(dtheta).
  double sin_turn = 0;  ///< sin(dtheta).
};

/// The exact arc of the unicycle x' = v cos theta, y' = v sin theta, theta' = w held for dt
/// seconds: speed in m/s, turn in rad/s. Exact to rounding for every turn, also none. Inline,
/// because simulated robots do little else.
[[nodiscard]] inline Arc makeArcOf(double speed, double turn, double dt) {
  Arc arc;
  arc.dtheta = turn * dt;
  // The chord of the arc is at half the turn: no difference of nearly equal numbers for small
  // turns.
  const double half = arc.dtheta / 2;
  double cosine, sine, sine_over_half;
  if (std::fabs(half) < 0.1) {
    // The first terms left out are below 0.1^10 / 10! = 3e-17. No case for a turn of 0.
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

/// The same for wheel speeds in m/s and a wheel base d in m: v = (v_l + v_r) / 2 and
/// w = (v_r - v_l) / d (paper, eq. 1).
[[nodiscard]] Arc makeArc(double left, double right, double wheel_base, double dt);

/// Moves a pose along an arc.
[[nodiscard]] Pose apply(const Arc& arc, const Pose& pose);

/// One wheel with its motor driver.
struct WheelModel {
  bool ideal = false;         ///< True: no quantisation by the pulse width modulation.
  double gain = 1;            ///< Real over commanded speed (an uncalibrated wheel is not 1).
  int32_t max_um_s = 270000;  ///< Speed at full duty, micrometre/s.
};

/// The speed (m/s) a wheel turns at when commanded um_s: clamped, quantised to the nearest of the
/// duties 0..255 unless ideal, times the gain.
[[nodiscard]] double wheelSpeed(int32_t um_s, const WheelModel& wheel);

}  // namespace dynamics
}  // namespace lab
