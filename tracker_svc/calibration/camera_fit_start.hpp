/// Where the search for a camera begins: homographies of boards (Zhang 2000). Used by camera_fit.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// From places on a board [m, homogeneous] to pixels; distortion goes unseen.
[[nodiscard]] std::optional<Eigen::Matrix3d> homographyOf(const std::vector<BoardPoint>& points);

/// Focal length [px] for square pixels with the principal point in the middle, from boards that are
/// tilted enough; empty where they are not.
[[nodiscard]] std::optional<double> focalLengthOf(const std::vector<Eigen::Matrix3d>& homographies,
                                                  int width, int height);

/// Pose of the board for a camera without distortion.
[[nodiscard]] BoardPose boardPose(const Eigen::Matrix3d& homography,
                                  const optics::CameraParameters& camera);

}  // namespace lab::calibration
