/// Report of a camera calibration for users.
#pragma once

#include <string>

#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// The parameters with standard errors, the residuals, and a map over the arena with the standard
/// error of positions [mm] and the mean residual of the spacings [um] at each place.
[[nodiscard]] std::string cameraReport(const CameraFit& fit);

}  // namespace lab::calibration
