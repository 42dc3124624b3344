/// The motors of a robot as `lab calibrate motors` describes them.
#pragma once

namespace lab::calibration {

/// One wheel: it stands up to the dead band and turns at
/// max * gain * (|u| - dead_band) / (1 - dead_band) above it, u being the share of full duty.
struct Wheel {
  double gain = 1;       ///< [1] real over nominal speed at full duty
  double dead_band = 0;  ///< [1] share of full duty; below 0 only as the outcome of a fit
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

/// What a pair of wheel speeds [m/s] makes of a robot.
[[nodiscard]] Motion motionOf(double left, double right, double wheel_base);

/// What a pair of duties makes of a robot.
[[nodiscard]] Motion motionOf(const Motors& motors, double duty_left, double duty_right,
                              double max);

/// The signed duty -1..1 that a robot which believes `stored` gives to a wheel for a speed [m/s].
/// @param steps whether it has the 256 levels of the robot's PWM
[[nodiscard]] double dutyFor(const Wheel& stored, double speed, double max, bool steps);

/// The nearest values that a robot can hold: millionths, whole duties (of 255) and micrometres.
[[nodiscard]] Motors storable(const Motors& motors);

}  // namespace lab::calibration
