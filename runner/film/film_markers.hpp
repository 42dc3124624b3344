/// What `lab track` tracks, and the camera that it assumes.
#pragma once

#include "common/calibration/camera_file.hpp"
#include "runner/film/film_commands.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::runner {

/// @param cap of the calibration, for the height of tags
/// @throws UserError if options are missing, or do not belong to the kind of markers
[[nodiscard]] detector::MarkerSettings markersOf(const TrackOptions& options,
                                                 const CameraCalibration& calibration);

/// A camera straight above, for pictures of this size [px]: one pixel shows `cm_per_px`, the origin
/// is in the lower left corner of the picture.
[[nodiscard]] CameraCalibration cameraAbove(int width, int height, double cm_per_px);

}  // namespace lab::runner
