/// Axes and poses of blobs, and groups of neighbours.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "tracker_svc/blobs/blob_moments.hpp"
#include "tracker_svc/detection.hpp"

namespace lab::detector {

/// Principal second moments.
struct BlobAxes {
  double major = 0;     ///< [px^2]
  double minor = 0;     ///< [px^2]
  double angle = 0;     ///< [rad] of the long axis, from x to the right towards y down
  double variance = 0;  ///< [rad^2] of the angle

  /// Without the blur [px].
  [[nodiscard]] BlobAxes sharpened(double blur) const;
};

[[nodiscard]] BlobAxes axesOf(const BlobMoments& moments);

/// The pose of a blob, with its axis as heading, length and width. The centre is that of the blob
/// on the plane, which perspective moves from the one in the picture.
/// @return empty if the plane is not seen there
[[nodiscard]] std::optional<Detection> blobPose(const optics::CameraModel& camera, double height,
                                                const BlobMoments& moments, double blur);

/// Connected components of a graph.
/// @param neighbours of each node
[[nodiscard]] std::vector<std::vector<std::size_t>> groupsOf(
    const std::vector<std::vector<int>>& neighbours);

}  // namespace lab::detector
