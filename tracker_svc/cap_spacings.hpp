/// Checks the camera calibration by the spacing of detected circles, live and in recordings.
#pragma once

#include "common/calibration/camera_file.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::tracker {

[[nodiscard]] calibration::SpacingSettings spacingSettings(const CameraCalibration& calibration);

/// Adds the measured spacing of a cap's two circles, unless one was not seen or a light edge
/// crosses one.
/// @param time [s]
/// @param spacing [m] true spacing
/// @return whether it was added
bool addSpacing(calibration::SpacingCheck& check, double time, const detector::Detection& cap,
                double spacing);

}  // namespace lab::tracker
