/// Poses from points measured on a cap, all in the cap plane, and the error of a point by glare.
/// Uses no picture.
#pragma once

#include <array>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"

namespace lab::detector {

/// A measured point.
struct MeasuredPoint {
  optics::Place place;                 ///< [m]
  std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy
};

/// Paint and blur estimated by a circle's fit.
struct PaintEstimate {
  double white = 0;  ///< [DN] grey value (digital number) of the cap around it
  double ratio = 0;  ///< [1] dark / white
  double error = 0;  ///< [1] standard error of the ratio
  double blur = 0;   ///< [px] of the outline
};

/// [px] possible displacement of a circle by glare (reflected light on top of the paint).
///
/// Glare makes black paint brighter. If it affects one circle more than the other, it also varies
/// across that circle, by about the same difference. This displaces the outline by the difference
/// divided by the slope of the outline. Effects equal on both circles (haze, another
/// black level, other paint) do not displace them and are ignored.
[[nodiscard]] double shiftByGlare(const PaintEstimate& circle, const PaintEstimate& other);

struct CapPose {
  double x = 0;                        ///< [m] the robot's axis
  double y = 0;                        ///< [m]
  double theta = 0;                    ///< [rad] (-pi, pi]
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  /// chi^2 of one degree of freedom: measured against known distance of the points
  double spacing_chi2 = 0;
};

/// From the centres of both circles. Their distance does not enter the pose, only `spacing_chi2`.
[[nodiscard]] CapPose poseFromCircles(const MeasuredPoint& big, const MeasuredPoint& small,
                                      const optics::CapGeometry& cap);

/// From one circle and the middle of the cap, which have a known distance, by least squares.
/// @param offset [m] of the circle on its cap, as in CapGeometry
[[nodiscard]] CapPose poseFromRim(const MeasuredPoint& circle, double offset,
                                  const MeasuredPoint& middle);

}  // namespace lab::detector
