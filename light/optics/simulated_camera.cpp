#include "light/optics/simulated_camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace lab::optics {
namespace {

constexpr double kHeight = 1.72;       // [m] for the paper's arena; higher for a larger one
constexpr double kArenaWidth = 1.20;   // [m]
constexpr double kArenaHeight = 0.90;  // [m]
constexpr double kFilled = 0.90;       // of the picture, along the tighter side
constexpr double kTiltX = 0.05;        // [rad] away from straight down
constexpr double kTiltY = -0.035;      // [rad]
constexpr double kTurn = 0.02;         // [rad] rotation of the picture relative to the arena
constexpr double kCapHeight = 0.05;    // [m]

}  // namespace

CameraParameters simulatedCamera(int columns, int rows, double width, double height) {
  CameraParameters p;
  p.width = columns;
  p.height = rows;
  p.k1 = -0.12;
  p.k2 = 0.02;
  p.p1 = 0.0004;
  p.p2 = -0.0003;
  const double distance = kHeight * std::max({1.0, width / kArenaWidth, height / kArenaHeight});
  const double focal = kFilled * (distance - kCapHeight) * std::min(columns / width, rows / height);
  p.fx = focal;
  p.fy = focal * 1.0007;
  p.cx = (columns - 1) / 2.0 + 0.006 * columns;
  p.cy = (rows - 1) / 2.0 - 0.008 * rows;

  // Looking down: camera x right in the picture, arena y up in it, arena z towards the camera.
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(kTiltX, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(kTiltY, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(kTurn, Eigen::Vector3d::UnitZ()))
                                       .toRotationMatrix() *
                                   down;
  // The middle of the arena at cap height is imaged to the middle of the picture.
  const Eigen::Vector3d middle(width / 2, height / 2, kCapHeight);
  const Eigen::Vector3d seen((columns / 2.0 - p.cx) / p.fx * distance,
                             (rows / 2.0 - p.cy) / p.fy * distance, distance - kCapHeight);
  const Eigen::Vector3d t = seen - rotation * middle;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      p.rotation[static_cast<std::size_t>(3 * i + j)] = rotation(i, j);
    }
    p.translation[static_cast<std::size_t>(i)] = t(i);
  }
  return p;
}

CameraParameters simulatedCameraAbove(int columns, int rows, double x, double y, double width,
                                      double height) {
  return movedCamera(simulatedCamera(columns, rows, width, height), x, y);
}

CameraParameters movedCamera(CameraParameters camera, double x, double y) {
  for (std::size_t i = 0; i < 3; ++i) {
    camera.translation[i] -= camera.rotation[3 * i] * x + camera.rotation[3 * i + 1] * y;
  }
  return camera;
}

}  // namespace lab::optics
