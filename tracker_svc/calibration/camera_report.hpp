/// What people read about a calibrated camera.
#pragma once

#include <string>

#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// The camera's numbers with their standard errors, the residuals, and the map over the arena: for
/// each place the standard error of positions [mm] and the mean residual of the spacings [um].
[[nodiscard]] std::string cameraReport(const CameraFit& fit);

}  // namespace lab::calibration
