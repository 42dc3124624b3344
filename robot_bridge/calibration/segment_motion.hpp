/// Fits a robot's motion at constant wheel speeds to its tracked poses.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace lab::calibration {

/// One tracked pose.
struct TrackPoint {
  double time = 0;   ///< [s] with any origin
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad] wrapped or not
};

/// Standard deviations of tracked poses.
struct TrackNoise {
  double position = 3e-4;  ///< [m] per axis
  double heading = 0.01;   ///< [rad]
};

/// The motion at constant wheel speeds that fits a track best.
struct SegmentMotion {
  Eigen::Vector2d value;        ///< speed [m/s] and turn [rad/s]
  Eigen::Matrix2d covariance;   ///< of `value`, for the given noise
  double position_squares = 0;  ///< [m^2] sum of squared residuals of positions, both axes
  double heading_squares = 0;   ///< [rad^2] sum of squared residuals of headings
  int points = 0;
};

inline constexpr int kFewestPoints = 8;

/// Fits x, y and heading of all points together: the heading changes at a constant rate, and the
/// tracked point moves along the resulting arc. The direction of motion may differ from the tracked
/// heading by a constant angle, as with a rotated marker or one beside the centre of the axis; the
/// speed is the component along the heading.
/// @return empty for fewer than kFewestPoints points, or if all points have the same time
[[nodiscard]] std::optional<SegmentMotion> fitMotion(const std::vector<TrackPoint>& track,
                                                     const TrackNoise& noise);

}  // namespace lab::calibration
