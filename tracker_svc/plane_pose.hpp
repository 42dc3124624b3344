/// From points and directions in the picture to those on a plane above the floor.
#pragma once

#include <array>
#include <optional>

#include "light/optics/camera_model.hpp"
#include "tracker_svc/detection.hpp"

namespace lab::detector {

[[nodiscard]] constexpr double determinant(const optics::PlaneScale& s) {
  return s.ux * s.vy - s.uy * s.vx;
}

/// A point of a plane.
struct PlanePoint {
  optics::Place place;
  optics::PlaneScale scale;      ///< d(pixel) / d(place) [px/m]
  optics::PlaneScale per_pixel;  ///< its inverse: ux = dx/du, uy = dx/dv, vx = dy/du, vy = dy/dv
};

/// Empty if the plane is not seen there.
[[nodiscard]] std::optional<PlanePoint> planePoint(const optics::CameraModel& camera,
                                                   optics::Pixel pixel, double height);

/// A pose of a point and a direction in the picture.
/// @param angle [rad] of the direction, from x to the right towards y down
/// @param covariance [px^2, px rad, rad^2] xx, xy, xt, yy, yt, tt in the picture
/// @return empty if the plane is not seen there
[[nodiscard]] std::optional<Detection> partPose(const optics::CameraModel& camera, double height,
                                                optics::Pixel centre, double angle,
                                                const std::array<double, 6>& covariance);

/// Sets the heading to unknown.
void forgetHeading(Detection& detection);

}  // namespace lab::detector
