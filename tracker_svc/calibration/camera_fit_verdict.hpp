/// Decides whether a fitted camera is accepted as a calibration. Internal to camera_fit.
#pragma once

#include <string>

#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// Fitted minus measured height of the camera, in standard deviations; 0 if not measured.
[[nodiscard]] double heightResidual(const CameraObservations& observations,
                                    const optics::CameraParameters& camera);

/// Why the caps do not cover the arena, using an approximate camera; empty if they do.
[[nodiscard]] std::string coverageFault(const CameraObservations& observations,
                                        const optics::CameraParameters& camera,
                                        const CameraFitLimits& limits);

/// Why the fit is rejected; empty if it is accepted.
[[nodiscard]] std::string refusalOf(const CameraObservations& observations, const CameraFit& fit,
                                    const CameraFitLimits& limits);

}  // namespace lab::calibration
