/// Nonlinear least squares over a camera and the poses of boards.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "light/optics/camera_model.hpp"

namespace lab::calibration {

/// Pose of a board in camera coordinates.
struct BoardPose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

enum CameraUnknown : int {
  kFx,
  kFy,
  kCx,
  kCy,
  kK1,
  kK2,
  kP1,
  kP2,
  kK3,
  kTurn,                  ///< three: rotation vector of the camera
  kShift = kTurn + 3,     ///< three: the arena's middle in camera coordinates [m]
  kSpacing = kShift + 3,  ///< relative excess of the caps' width
  kCameraUnknowns,        ///< followed by six per board: turn, shift
};

struct CameraState {
  optics::CameraParameters camera;
  double spacing = 0;  ///< relative excess of the caps' width
  std::vector<BoardPose> boards;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< [m] in the arena: fixed point of rotations

  [[nodiscard]] int unknowns() const {
    return kCameraUnknowns + 6 * static_cast<int>(boards.size());
  }
  [[nodiscard]] CameraState moved(const Eigen::VectorXd& by) const;
  [[nodiscard]] CameraState moved(int unknown, double by) const;

  /// Step for numerical derivatives: small, but well above rounding [unit of the unknown].
  [[nodiscard]] static double step(int unknown);
};

/// Residuals in units of their standard deviations, and the unknowns they depend on.
struct ResidualBlock {
  std::vector<int> unknowns;
  std::function<Eigen::VectorXd(const CameraState&)> residuals;
  bool robust = false;  ///< use Huber weights
};

struct CameraSolution {
  CameraState state;
  Eigen::MatrixXd covariance;  ///< of the unknowns, if determined
  double cost = 0;
  bool determined = false;
};

/// d residuals / d unknowns, by central differences.
[[nodiscard]] Eigen::MatrixXd jacobianOf(const ResidualBlock& block, const CameraState& state);

/// Minimises the sum of squared residuals (Huber cost for robust blocks) over the camera and the
/// poses of the boards. Not determined if an unknown does not affect the residuals.
[[nodiscard]] CameraSolution solveCamera(const std::vector<ResidualBlock>& blocks,
                                         const CameraState& start);

}  // namespace lab::calibration
