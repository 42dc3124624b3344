/// Compares ordered motion with tracked motion.
#pragma once

#include <vector>

#include "robot_bridge/calibration/motor_fit.hpp"

namespace lab::calibration {

/// A segment with the ordered wheel speeds.
struct CheckedSegment {
  double left = 0;   ///< [m/s]
  double right = 0;  ///< [m/s]
  Segment segment;   ///< with the resulting duties
};

[[nodiscard]] std::vector<Segment> segmentsOf(const std::vector<CheckedSegment>& checked);

/// Errors of the motion, as rms over the segments of a check.
struct SpeedCheck {
  int used = 0;             ///< segments
  int driven = 0;           ///< segments
  double speed = 0;         ///< [1] relative error of the speed in segments with speed
  double turn = 0;          ///< [1] relative error of the turning rate in segments with a turn
  double veer = 0;          ///< [rad/m] turn per distance in straight segments
  double motors_speed = 0;  ///< [1] as `speed`, without the effect of rounding to whole duties
  double motors_turn = 0;   ///< [1] as `turn`, without the effect of rounding to whole duties
  double speed_noise = 0;   ///< [1] part of `speed` caused by the tracker's noise
  double turn_noise = 0;    ///< [1] part of `turn` caused by the tracker's noise
};

/// @param stored calibration in the robot, which its host uses too
/// @param lateral offset of the tracked point [m], from MotorFit
[[nodiscard]] SpeedCheck checkSpeeds(const std::vector<CheckedSegment>& segments,
                                     const Motors& stored, double max, double lateral);

}  // namespace lab::calibration
