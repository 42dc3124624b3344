/// Whether a fitted camera is a calibration. Used by camera_fit only.
#pragma once

#include <string>

#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// Height of the camera, found less measured, in standard deviations; 0 where nobody measured it.
[[nodiscard]] double heightResidual(const CameraObservations& observations,
                                    const optics::CameraParameters& camera);

/// Why the caps do not say enough, by where they are for a rough camera; empty: they do.
[[nodiscard]] std::string coverageFault(const CameraObservations& observations,
                                        const optics::CameraParameters& camera,
                                        const CameraFitLimits& limits);

/// Why the fit is no calibration, empty: it is one.
[[nodiscard]] std::string refusalOf(const CameraObservations& observations, const CameraFit& fit,
                                    const CameraFitLimits& limits);

}  // namespace lab::calibration
