/// Fits the motor parameters of one robot to its tracked motion at known duties.
#pragma once

#include <string>
#include <vector>

#include "robot_bridge/calibration/motors.hpp"
#include "robot_bridge/calibration/segment_motion.hpp"

namespace lab::calibration {

/// Constant duties, and the poses tracked meanwhile.
struct Segment {
  double duty_left = 0;   ///< -1..1
  double duty_right = 0;  ///< -1..1
  int frames = 0;         ///< expected number of camera frames
  std::vector<TrackPoint> track;
};

/// How many segments of a pattern were used, and why others were not.
struct SegmentCounts {
  int driven = 0;
  int used = 0;
  int unseen = 0;    ///< the tracker saw the robot in fewer than half of the frames
  int uneven = 0;    ///< the motion was not uniform, for example because of a contact
  int outlying = 0;  ///< the motion was uniform, but inconsistent with the other segments
};

/// Motors with their standard errors.
struct MotorFit {
  Motors motors;
  Motors error;              ///< standard errors of `motors`
  double lateral = 0;        ///< [m] offset of the tracked point to the left of the axis' centre
  double lateral_error = 0;  ///< [m]
  TrackNoise noise;          ///< as estimated
  SegmentCounts segments;
  double chi2_per_dof = 0;  ///< if above 1, the errors are multiplied by its square root
  double residual = 0;      ///< [1] rms residual of the wheel speeds, divided by the rms speed
  std::string refusal;      ///< why the fit is not accepted; empty if it is
};

/// Conditions for accepting a fit.
struct FitLimits {
  double used_share = 0.75;       ///< smallest share of segments used
  double residual = 0.03;         ///< largest residual
  double gain_error = 0.01;       ///< [1] largest standard error
  double base_error = 0.02;       ///< [1] of the wheel base, relative
  double dead_band_error = 0.02;  ///< [1] of full duty
};

/// Weighted least squares over all segments for gain and dead band of each wheel, the wheel base
/// and the lateral offset of the tracked point. The tracker's noise is estimated from the scatter
/// of the poses. Segments without track, with non-uniform motion, and outliers are excluded and
/// counted.
/// @param nominal nominal motors, where the search starts
/// @param max [m/s] nominal speed at full duty
[[nodiscard]] MotorFit fitMotors(const std::vector<Segment>& segments, const Motors& nominal,
                                 double max, const FitLimits& limits = {});

/// The calibration in the form that a robot can store: dead bands are rounded to whole duties, and
/// the other parameters are fitted again with these.
[[nodiscard]] Motors fitStorable(const MotorFit& fit, const std::vector<Segment>& segments,
                                 double max);

}  // namespace lab::calibration
