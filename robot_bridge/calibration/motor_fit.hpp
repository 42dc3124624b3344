/// The motors of one robot from its tracked motion at known duties.
#pragma once

#include <string>
#include <vector>

#include "robot_bridge/calibration/motors.hpp"
#include "robot_bridge/calibration/segment_motion.hpp"

namespace lab::calibration {

/// The wheels kept these duties while the robot was seen at these poses.
struct Segment {
  double duty_left = 0;   ///< -1..1
  double duty_right = 0;  ///< -1..1
  int frames = 0;         ///< that the camera should have taken meanwhile
  std::vector<TrackPoint> track;
};

/// Where the segments of a pattern went.
struct SegmentCounts {
  int driven = 0;
  int used = 0;
  int unseen = 0;    ///< the tracker saw the robot in fewer than half of the frames
  int uneven = 0;    ///< the robot did not move evenly, as in a contact
  int outlying = 0;  ///< moved evenly, but far from what the other segments say
};

/// Motors with their standard errors.
struct MotorFit {
  Motors motors;
  Motors error;        ///< standard errors of the same
  double lateral = 0;  ///< [m] the tracked point lies this far to the left of the wheels' middle
  double lateral_error = 0;  ///< [m]
  TrackNoise noise;          ///< as estimated
  SegmentCounts segments;
  double chi2_per_dof = 0;  ///< errors are widened by its square root where it is above 1
  double residual = 0;      ///< [1] rms of what the wheels' speeds miss, over the rms of the speeds
  std::string refusal;      ///< not empty: why this is no calibration
};

/// What makes a fit a calibration.
struct FitLimits {
  double used_share = 0.75;       ///< of the segments, at least
  double residual = 0.03;         ///< at most
  double gain_error = 0.01;       ///< [1] largest standard error
  double base_error = 0.02;       ///< [1] of the wheel base, relative
  double dead_band_error = 0.02;  ///< [1] of full duty
};

/// Weighted least squares over all segments for the gain and the dead band of each wheel, the wheel
/// base and the lateral place of the tracked point. The tracker's noise is estimated from the
/// scatter of the poses. Segments without track, uneven ones and outliers are left out and counted.
/// @param nominal what the robot was built as: where the search starts
/// @param max [m/s] nominal speed at full duty
[[nodiscard]] MotorFit fitMotors(const std::vector<Segment>& segments, const Motors& nominal,
                                 double max, const FitLimits& limits = {});

/// The calibration that a robot can hold: dead bands are whole duties there, and the rest is fitted
/// again for these.
[[nodiscard]] Motors fitStorable(const MotorFit& fit, const std::vector<Segment>& segments,
                                 double max);

}  // namespace lab::calibration
