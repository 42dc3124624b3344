/// How large a cap appears where: the camera's geometry over the picture, worked out once.
#pragma once

#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::detector {

/// The cap plane around one pixel.
struct LocalScale {
  float inverse[4] = {0, 0, 0, 0};  ///< d(x, y)/d(pixel), row by row [m/px]
  float forward[4] = {0, 0, 0, 0};  ///< d(pixel)/d(x, y), row by row [px/m]
  float mean = 0;                   ///< [px/m] geometric mean, 0: no cap can be seen here
  float bend[2] = {0, 0};  ///< [px/m^2] outline's centre less the circle's, by its radius^2
  float unused = 0;        ///< fills up four numbers that are worked on together
};

/// A regular grid of LocalScale with linear interpolation between; errors below 0.1 % for a camera
/// that looks down on the arena.
class ScaleMap {
 public:
  ScaleMap(const optics::CameraModel& camera, const optics::CapGeometry& cap);

  /// The nodes around the pixel, interpolated; mean is 0 where one of them sees no cap plane.
  [[nodiscard]] LocalScale at(double x, double y) const;

  /// The nearest node: for what need not be known to better than a percent.
  [[nodiscard]] const LocalScale& near(double x, double y) const;

  [[nodiscard]] float smallest() const { return smallest_; }  ///< [px/m] over the picture
  [[nodiscard]] float largest() const { return largest_; }    ///< [px/m]

 private:
  int columns_ = 0;
  int rows_ = 0;
  float smallest_ = 0;
  float largest_ = 0;
  std::vector<LocalScale> nodes_;
};

/// Outline of a circle of this radius [m] there.
[[nodiscard]] DiscShape discShape(const LocalScale& scale, double radius);

}  // namespace lab::detector
