#include "tracker_svc/plane_pose.hpp"

#include <cmath>
#include <numbers>

namespace lab::detector {

std::optional<PlanePoint> planePoint(const optics::CameraModel& camera, optics::Pixel pixel,
                                     double height) {
  const std::optional<optics::Place> place = camera.toPlane(pixel, height);
  if (!place) return {};
  const optics::PlaneScale scale = camera.scaleAt(*place, height);
  const double det = determinant(scale);
  if (!(std::abs(det) > 0)) return {};
  return PlanePoint{
      *place, scale, {scale.vy / det, -scale.uy / det, -scale.vx / det, scale.ux / det}};
}

std::optional<Detection> partPose(const optics::CameraModel& camera, double height,
                                  optics::Pixel centre, double angle,
                                  const std::array<double, 6>& c) {
  const std::optional<PlanePoint> at = planePoint(camera, centre, height);
  if (!at) return {};
  const optics::PlaneScale& s = at->per_pixel;
  Detection pose;
  pose.x = at->place.x;
  pose.y = at->place.y;
  pose.middle = centre;
  const double u = std::cos(angle);
  const double v = std::sin(angle);
  const double x = s.ux * u + s.uy * v;
  const double y = s.vx * u + s.vy * v;
  pose.theta = std::atan2(y, x);
  // d(theta) / d(angle): the rotation of the direction, over its change of length.
  const double turn = determinant(s) / (x * x + y * y);
  pose.covariance = {s.ux * s.ux * c[0] + 2 * s.ux * s.uy * c[1] + s.uy * s.uy * c[3],
                     s.ux * s.vx * c[0] + (s.ux * s.vy + s.uy * s.vx) * c[1] + s.uy * s.vy * c[3],
                     turn * (s.ux * c[2] + s.uy * c[4]),
                     s.vx * s.vx * c[0] + 2 * s.vx * s.vy * c[1] + s.vy * s.vy * c[3],
                     turn * (s.vx * c[2] + s.vy * c[4]),
                     turn * turn * c[5]};
  return pose;
}

void forgetHeading(Detection& detection) {
  detection.heading = HeadingKind::kUnknown;
  detection.theta = 0;
  detection.covariance[2] = detection.covariance[4] = 0;
  detection.covariance[5] = std::numbers::pi * std::numbers::pi / 3;
}

}  // namespace lab::detector
