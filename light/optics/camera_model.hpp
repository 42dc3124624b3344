/// Projection from the arena to the picture and back: a pinhole camera with lens distortion,
/// anywhere above the arena. Pictures are never resampled; only points are undistorted.
#pragma once

#include <array>
#include <optional>

#include "light/optics/grey_image.hpp"

namespace lab::optics {

/// A place in the arena frame [m].
struct Place {
  double x = 0;
  double y = 0;
};

/// Pinhole with the distortion of Brown and Conrady, as OpenCV writes it: with a = X/Z, b = Y/Z and
/// r2 = a^2 + b^2 of a point in camera coordinates,
///   a' = a (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 a b + p2 (r2 + 2 a^2)
///   b' = b (1 + k1 r2 + k2 r2^2 + k3 r2^3) + p1 (r2 + 2 b^2) + 2 p2 a b
///   u = fx a' + cx, v = fy b' + cy.
/// Camera coordinates are R X + t of the arena's (x, y, z), z up [m]; x of the camera right in the
/// picture, y down, z away from it.
struct CameraParameters {
  int width = 0;   ///< [px] of the pictures that the parameters belong to
  int height = 0;  ///< [px]
  double fx = 0;   ///< [px]
  double fy = 0;   ///< [px]
  double cx = 0;   ///< [px]
  double cy = 0;   ///< [px]
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  std::array<double, 9> rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< R, row by row
  std::array<double, 3> translation = {0, 0, 0};                 ///< t [m]

  bool operator==(const CameraParameters&) const = default;
};

/// d(pixel) / d(x, y) on a plane of constant height [px/m].
struct PlaneScale {
  double ux = 0;  ///< du/dx
  double uy = 0;  ///< du/dy
  double vx = 0;  ///< dv/dx
  double vy = 0;  ///< dv/dy
};

class CameraModel {
 public:
  CameraModel() = default;
  explicit CameraModel(const CameraParameters& parameters) : p_(parameters) {}

  [[nodiscard]] const CameraParameters& parameters() const { return p_; }

  /// Image of the point (x, y, z) [m] of the arena, which must lie in front of the camera.
  [[nodiscard]] Pixel project(double x, double y, double z) const;

  /// The same, with the derivative by x and y.
  [[nodiscard]] Pixel project(double x, double y, double z, PlaneScale& scale) const;

  /// The place at height z [m] that is imaged to this pixel; empty if the line of sight does not
  /// meet the plane in front of the camera, or if the lens model cannot be inverted.
  [[nodiscard]] std::optional<Place> toPlane(Pixel pixel, double z) const;

  /// The derivative of project() by x and y.
  [[nodiscard]] PlaneScale scaleAt(Place place, double z) const;

  /// Position of the camera in the arena frame: x, y, z [m].
  [[nodiscard]] std::array<double, 3> centre() const;

 private:
  CameraParameters p_;
};

}  // namespace lab::optics
