#include "light/optics/camera_model.hpp"

#include <cmath>

namespace lab::optics {
namespace {

struct Distorted {
  double a = 0;
  double b = 0;
  double aa = 1, ab = 0, ba = 0, bb = 1;  ///< da'/da, da'/db, db'/da, db'/db
};

Distorted distort(const CameraParameters& p, double a, double b) {
  const double r2 = a * a + b * b;
  const double radial = 1 + r2 * (p.k1 + r2 * (p.k2 + r2 * p.k3));
  const double slope = p.k1 + r2 * (2 * p.k2 + 3 * p.k3 * r2);  // d radial / d r2
  Distorted out;
  out.a = a * radial + 2 * p.p1 * a * b + p.p2 * (r2 + 2 * a * a);
  out.b = b * radial + p.p1 * (r2 + 2 * b * b) + 2 * p.p2 * a * b;
  out.aa = radial + 2 * a * a * slope + 2 * p.p1 * b + 6 * p.p2 * a;
  out.ab = 2 * a * b * slope + 2 * p.p1 * a + 2 * p.p2 * b;
  out.ba = 2 * a * b * slope + 2 * p.p1 * a + 2 * p.p2 * b;
  out.bb = radial + 2 * b * b * slope + 6 * p.p1 * b + 2 * p.p2 * a;
  return out;
}

}  // namespace

Pixel CameraModel::project(double x, double y, double z) const {
  PlaneScale unused;
  return project(x, y, z, unused);
}

Pixel CameraModel::project(double x, double y, double z, PlaneScale& scale) const {
  const auto& r = p_.rotation;
  const auto& t = p_.translation;
  const double cx = r[0] * x + r[1] * y + r[2] * z + t[0];
  const double cy = r[3] * x + r[4] * y + r[5] * z + t[1];
  const double depth = r[6] * x + r[7] * y + r[8] * z + t[2];
  const double a = cx / depth;
  const double b = cy / depth;
  const Distorted d = distort(p_, a, b);
  const double ax = (r[0] - a * r[6]) / depth;
  const double ay = (r[1] - a * r[7]) / depth;
  const double bx = (r[3] - b * r[6]) / depth;
  const double by = (r[4] - b * r[7]) / depth;
  scale.ux = p_.fx * (d.aa * ax + d.ab * bx);
  scale.uy = p_.fx * (d.aa * ay + d.ab * by);
  scale.vx = p_.fy * (d.ba * ax + d.bb * bx);
  scale.vy = p_.fy * (d.ba * ay + d.bb * by);
  return {p_.fx * d.a + p_.cx, p_.fy * d.b + p_.cy};
}

std::optional<Place> CameraModel::toPlane(Pixel pixel, double z) const {
  constexpr int kMostSteps = 20;
  // Newton's method converges quadratically: after an error below this, one more step is exact.
  constexpr double kClose = 1e-6;
  const double wanted_a = (pixel.x - p_.cx) / p_.fx;
  const double wanted_b = (pixel.y - p_.cy) / p_.fy;
  double a = wanted_a;
  double b = wanted_b;
  bool found = false;
  // Two or three Newton steps for a real lens.
  for (int step = 0; step < kMostSteps && !found; ++step) {
    const Distorted d = distort(p_, a, b);
    const double determinant = d.aa * d.bb - d.ab * d.ba;
    if (!(determinant > 0)) return std::nullopt;  // outside the invertible range of the lens model
    const double ea = wanted_a - d.a;
    const double eb = wanted_b - d.b;
    const double over = 1 / determinant;
    a += (d.bb * ea - d.ab * eb) * over;
    b += (d.aa * eb - d.ba * ea) * over;
    found = std::abs(ea) < kClose && std::abs(eb) < kClose;
  }
  if (!found) return std::nullopt;
  // Centre C = -R^T t; direction R^T (a, b, 1).
  const auto& r = p_.rotation;
  const std::array<double, 3> c = centre();
  const double dx = r[0] * a + r[3] * b + r[6];
  const double dy = r[1] * a + r[4] * b + r[7];
  const double dz = r[2] * a + r[5] * b + r[8];
  const double along = (z - c[2]) / dz;
  if (!(along > 0) || !std::isfinite(along)) return std::nullopt;
  return Place{c[0] + along * dx, c[1] + along * dy};
}

PlaneScale CameraModel::scaleAt(Place place, double z) const {
  PlaneScale scale;
  static_cast<void>(project(place.x, place.y, z, scale));
  return scale;
}

std::array<double, 3> CameraModel::centre() const {
  const auto& r = p_.rotation;
  const auto& t = p_.translation;
  return {-(r[0] * t[0] + r[3] * t[1] + r[6] * t[2]), -(r[1] * t[0] + r[4] * t[1] + r[7] * t[2]),
          -(r[2] * t[0] + r[5] * t[1] + r[8] * t[2])};
}

}  // namespace lab::optics
