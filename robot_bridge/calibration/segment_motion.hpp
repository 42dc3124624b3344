/// How a robot moved while its wheels kept their speeds, from its tracked poses.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace lab::calibration {

/// One tracked pose.
struct TrackPoint {
  double time = 0;   ///< [s] of any clock
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

/// Fits x, y and heading of all points together: the heading turns at a constant rate, and the
/// tracked point moves along the arc that follows from it. The direction of motion may differ from
/// the tracked heading by a constant angle, as with a marker that is glued on askew or off the
/// wheels' middle: the speed is the component along the heading.
/// @return nothing for fewer than kFewestPoints points, or points of no duration.
[[nodiscard]] std::optional<SegmentMotion> fitMotion(const std::vector<TrackPoint>& track,
                                                     const TrackNoise& noise);

}  // namespace lab::calibration
