/// A camera with known parameters, and its observations of caps, corners and boards.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/math/random.hpp"
#include "light/optics/simulated_camera.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// A random camera over an arena of 120 x 90 cm: slightly off the middle, tilted, with distortion
/// and pixels not exactly square.
inline optics::CameraParameters someCamera(Random& random, int columns, int rows) {
  optics::CameraParameters p = optics::simulatedCamera(columns, rows, 1.2, 0.9);
  const double height = 1.3 + random.uniform();
  const double focal = p.fx * (height - 0.05) / (1.72 - 0.05);
  p.fx = focal;
  p.fy = focal * (1 + 0.001 * random.normal());
  p.cx = (columns - 1) / 2.0 + 0.01 * columns * random.normal();
  p.cy = (rows - 1) / 2.0 + 0.01 * columns * random.normal();
  p.k1 = -0.15 + 0.2 * random.uniform();
  p.k2 = 0.05 * random.normal();
  p.p1 = 3e-4 * random.normal();
  p.p2 = 3e-4 * random.normal();
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const auto turn = [&random](double sigma, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(sigma * random.normal(), axis);
  };
  const Eigen::Matrix3d rotation =
      (turn(0.05, Eigen::Vector3d::UnitX()) * turn(0.05, Eigen::Vector3d::UnitY()) *
       turn(0.05, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix() *
      down;
  const Eigen::Vector3d middle(0.6, 0.45, 0);
  const Eigen::Vector3d seen(((columns - 1) / 2.0 - p.cx) / focal * height,
                             ((rows - 1) / 2.0 - p.cy) / focal * height, height);
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(p.rotation.data()) = rotation;
  Eigen::Map<Eigen::Vector3d>(p.translation.data()) = seen - rotation * middle;
  return p;
}

/// Centre of the ellipse of a circle: from a conic through points of its outline.
inline optics::Pixel ellipseCentre(const optics::CameraModel& model, double x, double y, double z,
                                   double radius) {
  constexpr int kPoints = 16;
  const optics::Pixel middle = model.project(x, y, z);
  Eigen::Matrix<double, kPoints, 5> conic;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPoints;
    const optics::Pixel at =
        model.project(x + radius * std::cos(angle), y + radius * std::sin(angle), z);
    const double u = at.x - middle.x;
    const double v = at.y - middle.y;
    conic.row(i) << u * u, u * v, v * v, u, v;
  }
  const Eigen::Matrix<double, 5, 1> c =
      conic.colPivHouseholderQr().solve(Eigen::Matrix<double, kPoints, 1>::Ones());
  const double determinant = 4 * c[0] * c[2] - c[1] * c[1];
  return {middle.x + (c[1] * c[4] - 2 * c[2] * c[3]) / determinant,
          middle.y + (c[1] * c[3] - 2 * c[0] * c[4]) / determinant};
}

struct SightNoise {
  double caps = 0.02;    ///< [px]
  double corners = 0.5;  ///< [px]
  double cap_make = 0;   ///< [1] common relative error of the caps' width
};

/// Caps at random places that robots can reach, within [x0, x1] of the width.
inline std::vector<CapObservation> capsSeen(const optics::CameraParameters& camera, int count,
                                            const SightNoise& noise, Random& random, double x0 = 0,
                                            double x1 = 1) {
  const optics::CameraModel model(camera);
  const optics::CapGeometry cap;
  std::vector<CapObservation> caps;
  const auto shake = [&](optics::Pixel at) {
    return optics::Pixel{at.x + noise.caps * random.normal(), at.y + noise.caps * random.normal()};
  };
  while (static_cast<int>(caps.size()) < count) {
    const double r = cap.robot_radius;
    const double x = std::clamp(1.2 * (x0 + (x1 - x0) * random.uniform()), r, 1.2 - r);
    const double y = r + (0.9 - 2 * r) * random.uniform();
    const double theta = 2 * std::numbers::pi * random.uniform();
    const auto at = [&](double offset, double radius) {
      const double made = offset * (1 + noise.cap_make);
      return ellipseCentre(model, x + made * std::cos(theta), y + made * std::sin(theta),
                           cap.height, radius);
    };
    const optics::Pixel big = shake(at(cap.big_offset, cap.big_radius));
    const optics::Pixel small = shake(at(cap.small_offset, cap.small_radius));
    caps.push_back({big, small, 0.02});
  }
  return caps;
}

/// Observations of an arena of 120 x 90 cm.
inline CameraObservations observationsOf(const optics::CameraParameters& camera, int caps,
                                         const SightNoise& noise, Random& random) {
  CameraObservations observations;
  observations.width = camera.width;
  observations.height = camera.height;
  observations.corner_sigma = std::max(noise.corners, 0.05);
  const optics::CameraModel model(camera);
  constexpr std::array<optics::Place, 4> kPlaces = {{{0, 0}, {1.2, 0}, {1.2, 0.9}, {0, 0.9}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const optics::Pixel at = model.project(kPlaces[i].x, kPlaces[i].y, 0);
    observations.corners[i] = {at.x + noise.corners * random.normal(),
                               at.y + noise.corners * random.normal()};
  }
  observations.caps = capsSeen(camera, caps, noise, random);
  return observations;
}

/// A board of 9 x 6 discs, 3 cm apart, in a random pose above the arena, completely visible.
inline BoardView boardSeen(const optics::CameraParameters& camera, double noise, Random& random) {
  BoardView view;
  for (;;) {
    view = {};
    view.disc_radius = 0.009;
    const Eigen::Vector3d at(0.2 + 0.8 * random.uniform(), 0.15 + 0.6 * random.uniform(),
                             0.3 * random.uniform());
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(2 * std::numbers::pi * random.uniform(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(0.6 * random.uniform(), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    optics::CameraParameters p = camera;
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Eigen::Matrix3d rotation = Eigen::Map<const RowMajor>(camera.rotation.data());
    Eigen::Map<RowMajor>(p.rotation.data()) = rotation * turn;
    Eigen::Map<Eigen::Vector3d>(p.translation.data()) += rotation * at;
    const optics::CameraModel model(p);
    bool inside = true;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 9; ++column) {
        BoardPoint point;
        point.x = 0.03 * (column - 4);
        point.y = 0.03 * (row - 2.5);
        const optics::Pixel centre = ellipseCentre(model, point.x, point.y, 0, view.disc_radius);
        point.pixel = {centre.x + noise * random.normal(), centre.y + noise * random.normal()};
        inside = inside && point.pixel.x > 10 && point.pixel.y > 10 &&
                 point.pixel.x < camera.width - 11 && point.pixel.y < camera.height - 11;
        view.points.push_back(point);
      }
    }
    if (inside) return view;
  }
}

/// Position errors of a fitted camera over the arena [m].
struct TrueError {
  double rms = 0;
  double largest = 0;
  double shape = 0;         ///< rms after removing the best common shift and rotation
  double largest_pull = 0;  ///< largest error over the map's places, in claimed sigmas
};

inline TrueError trueError(const CameraFit& fit, const optics::CameraParameters& truth,
                           const CameraObservations& observations) {
  const optics::CameraModel real(truth);
  const optics::CameraModel fitted(fit.camera);
  TrueError error;
  std::array<optics::Place, 25> misses;
  for (std::size_t i = 0; i < fit.map.places.size(); ++i) {
    const PlaceError& place = fit.map.places[i];
    const auto seen = fitted.toPlane(real.project(place.x, place.y, observations.cap.height),
                                     observations.cap.height);
    if (!seen) return {1, 1, 1, 1e9};
    misses[i] = {seen->x - place.x, seen->y - place.y};
    const double miss = std::hypot(misses[i].x, misses[i].y);
    error.rms += miss * miss / 25;
    error.largest = std::max(error.largest, miss);
    error.largest_pull = std::max(error.largest_pull, miss / place.frame);
  }
  error.rms = std::sqrt(error.rms);
  // Least-squares shift and small rotation about the middle.
  double dx = 0;
  double dy = 0;
  double moment = 0;
  double inertia = 0;
  for (std::size_t i = 0; i < misses.size(); ++i) {
    const double x = fit.map.places[i].x - 0.6;
    const double y = fit.map.places[i].y - 0.45;
    dx += misses[i].x / 25;
    dy += misses[i].y / 25;
    moment += x * misses[i].y - y * misses[i].x;
    inertia += x * x + y * y;
  }
  const double turn = moment / inertia;
  double rest = 0;
  for (std::size_t i = 0; i < misses.size(); ++i) {
    const double x = fit.map.places[i].x - 0.6;
    const double y = fit.map.places[i].y - 0.45;
    rest += std::pow(misses[i].x - dx + turn * y, 2) + std::pow(misses[i].y - dy - turn * x, 2);
  }
  error.shape = std::sqrt(rest / 25);
  return error;
}

}  // namespace lab::calibration
