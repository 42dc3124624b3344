#include "light/optics/simulated_projector.hpp"

#include <algorithm>
#include <cmath>

namespace lab::optics {
namespace {

constexpr double kThrow = 2.05;        // [m] from the lens down to sensor height
constexpr double kArenaWidth = 1.20;   // [m] nominal arena
constexpr double kArenaHeight = 0.90;  // [m]
constexpr int kBorderSteps = 256;      // along each side of the arena

/// Extent of the arena relative to the picture: 1 if it just fills it.
double reach(const CameraParameters& lens, double width, double height) {
  const CameraModel model(lens);
  double most = 0;
  const auto include = [&](double x, double y) {
    const Pixel pixel = model.project(x, y, kSensorHeight);
    most = std::max({most, std::abs(pixel.x - lens.cx) / (lens.width / 2.0),
                     std::abs(pixel.y - lens.cy) / (lens.height / 2.0)});
  };
  for (int i = 0; i <= kBorderSteps; ++i) {
    const double along = static_cast<double>(i) / kBorderSteps;
    include(along * width, 0);
    include(along * width, height);
    include(0, along * height);
    include(width, along * height);
  }
  return most;
}

}  // namespace

ProjectorModel simulatedProjector(double width, double height, int columns, int rows,
                                  const ProjectorFaults& faults) {
  if (faults == ProjectorFaults{}) return {width, height, columns, rows};
  const double distance = kThrow * std::max({1.0, width / kArenaWidth, height / kArenaHeight});
  CameraParameters p;
  p.width = columns;
  p.height = rows;
  p.fx = columns / width * distance;
  p.fy = rows / height * distance;
  p.cx = (columns - 1) / 2.0;
  p.cy = (rows - 1) / 2.0;
  const double radius2 = (width * width + height * height) / (4 * distance * distance);
  p.k1 = faults.barrel / (std::pow(1 - faults.barrel, 3) * radius2);
  // For a picture of half angle phi, tilted by theta, the far side is (1 + tan theta tan phi) / (1
  // - tan theta tan phi) times as far away, and as wide, as the near side.
  const double half_angle_tangent = height / (2 * distance);
  const double tilt = std::atan(faults.keystone / (2 + faults.keystone) / half_angle_tangent);
  const double c = std::cos(tilt);
  const double s = std::sin(tilt);
  // Straight down, rotated about x so that the depth increases towards y = 0.
  p.rotation = {1, 0, 0, 0, -c, s, 0, -s, -c};
  const auto aim = [&](double x, double y) {
    const auto& r = p.rotation;
    for (std::size_t i = 0; i < 3; ++i) {
      p.translation[i] = -r[3 * i] * x - r[3 * i + 1] * y - r[3 * i + 2] * kSensorHeight;
    }
    p.translation[2] += distance;
  };
  aim(width / 2, height / 2);
  const double zoom = 1 / reach(p, width, height);
  p.fx *= zoom;
  p.fy *= zoom;
  aim(width / 2 + faults.offset_x, height / 2 + faults.offset_y);
  return {p, kSensorHeight};
}

ProjectorWarp::ProjectorWarp(const ProjectorModel& assumed, const ProjectorModel& actual) {
  if (assumed.isNominal() && actual.isNominal()) return;
  assumed_ = assumed;
  actual_ = actual;
}

std::optional<Place> ProjectorWarp::source(Place place) const {
  if (isIdentity()) return place;
  if (!(marginInside(place) >= 0)) return std::nullopt;
  return sourceUnclipped(place);
}

std::optional<Place> ProjectorWarp::sourceUnclipped(Place place) const {
  if (isIdentity()) return place;
  return assumed_->placeOf(actual_->pixelOf(place));
}

double ProjectorWarp::marginInside(Place place) const {
  const Pixel pixel = actual_->pixelOf(place);
  return std::min(std::min(pixel.x + 0.5, actual_->columns() - 0.5 - pixel.x),
                  std::min(pixel.y + 0.5, actual_->rows() - 0.5 - pixel.y));
}

}  // namespace lab::optics
