/// The model of a robot's motors used by `lab calibrate motors`.
#pragma once

namespace lab::calibration {

/// One wheel: it stands up to the dead band; above it, its speed is
/// max * gain * (|u| - dead_band) / (1 - dead_band), where u is the share of full duty.
struct Wheel {
  double gain = 1;       ///< [1] real over nominal speed at full duty
  double dead_band = 0;  ///< [1] share of full duty; negative only as the result of a fit
  bool operator==(const Wheel&) const = default;
};

struct Motors {
  Wheel left;
  Wheel right;
  double wheel_base = 0.075;  ///< [m]
  bool operator==(const Motors&) const = default;
};

/// How a robot moves.
struct Motion {
  double speed = 0;  ///< [m/s]
  double turn = 0;   ///< [rad/s]
};

/// The speed of a wheel [m/s] at a signed duty of -1..1. @param max [m/s] nominal at full duty
[[nodiscard]] double wheelSpeed(const Wheel& wheel, double duty, double max);

/// The motion for a pair of wheel speeds [m/s].
[[nodiscard]] Motion motionOf(double left, double right, double wheel_base);

/// The motion for a pair of duties.
[[nodiscard]] Motion motionOf(const Motors& motors, double duty_left, double duty_right,
                              double max);

/// The signed duty -1..1 that a robot with the calibration `stored` uses for a speed [m/s].
/// @param steps whether the duty is rounded to the 256 levels of the robot's PWM
[[nodiscard]] double dutyFor(const Wheel& stored, double speed, double max, bool steps);

/// Rounds to the values that a robot can store: millionths, whole duties (of 255), micrometres.
[[nodiscard]] Motors storable(const Motors& motors);

}  // namespace lab::calibration
