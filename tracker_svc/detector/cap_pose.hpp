/// Poses from what was measured on a cap, all on the cap plane. No picture.
#pragma once

#include <array>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"

namespace lab::detector {

/// A point that was measured.
struct MeasuredPoint {
  optics::Place place;                 ///< [m]
  std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy
};

/// What a circle's fit says of its paint.
struct PaintEstimate {
  double white = 0;  ///< [DN] of the cap around it
  double ratio = 0;  ///< [1] dark / white
  double error = 0;  ///< [1] standard error of the ratio
  double blur = 0;   ///< [px] of the outline
};

/// [px] by which light on top, as from something shiny, may have moved a circle of a cap.
///
/// It makes black paint brighter than paint is. Where it does so to one circle more than to the
/// other one, it is not even over one of them either: about as much more on one side of its outline
/// than on the other, which moves the outline by that share of its slope. What is the same on both
/// circles (haze, another black level, another paint) moves nothing and counts for nothing.
[[nodiscard]] double shiftByGlare(const PaintEstimate& circle, const PaintEstimate& other);

struct CapPose {
  double x = 0;                        ///< [m] the robot's axis
  double y = 0;                        ///< [m]
  double theta = 0;                    ///< [rad] (-pi, pi]
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  double spacing_chi2 = 0;  ///< chi^2 of one degree of freedom: distance of the two points
};

/// From the centres of both circles: their distance is not held against them.
[[nodiscard]] CapPose poseFromCircles(const MeasuredPoint& big, const MeasuredPoint& small,
                                      const optics::CapGeometry& cap);

/// From one circle and the middle of the cap, by least squares: two points at a known distance.
/// @param offset [m] of the circle on its cap, CapGeometry's
[[nodiscard]] CapPose poseFromRim(const MeasuredPoint& circle, double offset,
                                  const MeasuredPoint& middle);

}  // namespace lab::detector
