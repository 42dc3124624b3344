/// Poses from what was measured on a cap, all on the cap plane. No picture.
#pragma once

#include <array>

#include "optics/camera_model.hpp"
#include "optics/cap.hpp"

namespace lab::tracker {

/// A point that was measured.
struct MarkedPlace {
  optics::Place place;                 ///< [m]
  std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy
};

struct CapPose {
  double x = 0;      ///< [m] the robot's axis
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad] (-pi, pi]
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  double surprise = 0;  ///< chi^2 of one degree of freedom: distance of the two points
};

/// From the centres of both circles: their distance is not held against them.
[[nodiscard]] CapPose poseFromCircles(const MarkedPlace& big, const MarkedPlace& small,
                                      const optics::CapGeometry& cap);

/// From one circle and the middle of the cap, by least squares: two points at a known distance.
/// @param offset [m] of the circle on its cap, CapGeometry's
[[nodiscard]] CapPose poseFromRim(const MarkedPlace& circle, double offset,
                                  const MarkedPlace& middle);

}  // namespace lab::tracker
