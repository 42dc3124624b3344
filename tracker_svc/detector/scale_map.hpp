/// Scale of the cap plane at every place of the picture, computed once.
#pragma once

#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_fit.hpp"

namespace lab::detector {

/// Linearised projection of the cap plane around one pixel.
struct LocalScale {
  float inverse[4] = {0, 0, 0, 0};  ///< d(x, y)/d(pixel), row by row [m/px]
  float forward[4] = {0, 0, 0, 0};  ///< d(pixel)/d(x, y), row by row [px/m]
  float mean = 0;                   ///< [px/m] geometric mean, 0 if no cap can be visible here
  float bend[2] = {
      0, 0};  ///< [px/m^2] centre of a circle's outline minus image of its centre, per radius^2
  float unused = 0;  ///< pads to a multiple of four
};

/// A regular grid of LocalScale with linear interpolation. Errors are below 0.1 % for a camera that
/// looks down on the arena.
class ScaleMap {
 public:
  ScaleMap(const optics::CameraModel& camera, const optics::CapGeometry& cap);

  /// Interpolated between the nodes around the pixel; mean is 0 if one of them does not see the cap
  /// plane.
  [[nodiscard]] LocalScale at(double x, double y) const;

  /// The nearest node, accurate to a percent.
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

/// Outline of a circle of this radius [m].
[[nodiscard]] DiscShape discShape(const LocalScale& scale, double radius);

}  // namespace lab::detector
