/// Initial values for the camera fit: homographies of boards (Zhang 2000). Internal to camera_fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// Homography from positions on a board [m] to pixels; ignores distortion.
[[nodiscard]] std::optional<Eigen::Matrix3d> homographyOf(const std::vector<BoardPoint>& points);

/// Focal length [px] for square pixels with the principal point in the middle; empty unless some
/// boards are tilted enough.
[[nodiscard]] std::optional<double> focalLengthOf(const std::vector<Eigen::Matrix3d>& homographies,
                                                  int width, int height);

/// Pose of the board for a camera without distortion.
[[nodiscard]] BoardPose boardPose(const Eigen::Matrix3d& homography,
                                  const optics::CameraParameters& camera);

}  // namespace lab::calibration
