/// Covers a part of a cap in a picture, as a wire, a finger or a sticker would.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::detector {

/// A strip with round ends between two places at cap height [m], with soft edges.
struct Cover {
  optics::Place from;
  optics::Place to;
  double radius = 0.010;  ///< [m]
  double grey = 120;      ///< [DN]
};

inline void lay(const Cover& cover, const optics::CameraModel& camera, optics::GreyImage& picture) {
  constexpr double kSoft = 1.5;  // [px]
  const double height = optics::CapGeometry{}.height;
  const optics::Pixel a = camera.project(cover.from.x, cover.from.y, height);
  const optics::Pixel b = camera.project(cover.to.x, cover.to.y, height);
  const optics::PlaneScale scale = camera.scaleAt(cover.from, height);
  const double radius =
      cover.radius * std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double square = std::max(dx * dx + dy * dy, 1e-9);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double along = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / square, 0.0, 1.0);
      const double away = std::hypot(x - a.x - along * dx, y - a.y - along * dy);
      const double share = std::clamp((radius - away) / kSoft + 0.5, 0.0, 1.0);
      if (share <= 0) continue;
      std::uint8_t& pixel = picture.row(y)[x];
      pixel = static_cast<std::uint8_t>(std::lround(pixel + share * (cover.grey - pixel)));
    }
  }
}

/// The arena position of a place on a cap.
inline optics::Place onCap(const sim::PaintedRobot& robot, double forward, double left = 0) {
  const double c = std::cos(robot.theta);
  const double s = std::sin(robot.theta);
  return {robot.x + c * forward - s * left, robot.y + s * forward + c * left};
}

/// Covers only the small or the big circle, slightly off its centre.
inline Cover overCircle(const sim::PaintedRobot& robot, bool big) {
  const optics::CapGeometry cap;
  const optics::Place at = onCap(robot, big ? cap.big_offset : cap.small_offset, 0.001);
  return {at, at, big ? 0.012 : 0.009, 120};
}

}  // namespace lab::detector
