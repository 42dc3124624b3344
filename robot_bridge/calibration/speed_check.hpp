/// How well a robot does what it is told: asked motion against seen motion.
#pragma once

#include <vector>

#include "robot_bridge/calibration/motor_fit.hpp"

namespace lab::calibration {

/// A segment with the wheel speeds that were asked for.
struct CheckedSegment {
  double left = 0;   ///< [m/s]
  double right = 0;  ///< [m/s]
  Segment segment;   ///< with the duties that followed
};

[[nodiscard]] std::vector<Segment> segmentsOf(const std::vector<CheckedSegment>& checked);

/// What the robot misses, as rms over the segments of a check.
struct SpeedCheck {
  int used = 0;  ///< segments
  int driven = 0;
  double speed = 0;         ///< [1] error of the speed, relative, where it was to drive
  double turn = 0;          ///< [1] error of the turning rate, relative, where it was to turn
  double veer = 0;          ///< [rad/m] turn where it was to drive straight
  double motors_speed = 0;  ///< [1] as speed, less what rounding to whole duties explains
  double motors_turn = 0;   ///< [1] as turn, likewise
  double speed_noise = 0;   ///< [1] what the tracker's noise alone makes of `speed`
  double turn_noise = 0;    ///< [1] likewise of `turn`
};

/// @param believed what the robot and its host take the motors for
/// @param lateral [m] as fitted (MotorFit)
[[nodiscard]] SpeedCheck checkSpeeds(const std::vector<CheckedSegment>& segments,
                                     const Motors& believed, double max, double lateral);

}  // namespace lab::calibration
