/// What the caps that the tracker sees say of the camera's calibration, live and in films.
#pragma once

#include "common/calibration/camera_file.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::tracker {

[[nodiscard]] calibration::SpacingSettings spacingSettings(const CameraCalibration& calibration);

/// Takes the distance of a cap's two circles, unless one was not seen or a light edge crosses it.
/// @param time [s]
/// @param spacing [m] that is known
/// @return whether it was taken
bool addSpacing(calibration::SpacingCheck& check, double time, const detector::Detection& cap,
                double spacing);

}  // namespace lab::tracker
