/// Errors of positions on the cap plane with a fitted camera. Internal to camera_fit.
#pragma once

#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// Measured minus known spacing of a cap [m]; empty if the camera cannot see it.
[[nodiscard]] std::optional<double> spacingResidual(const optics::CameraModel& model,
                                                    const optics::CapGeometry& cap,
                                                    const CapObservation& observation);

/// Standard deviation of the measured spacing [m] from the sigma of its circles.
[[nodiscard]] std::optional<double> spacingSigma(const optics::CameraModel& model,
                                                 const optics::CapGeometry& cap,
                                                 const CapObservation& observation);

/// Standard errors of positions over the arena, from the covariance of the camera's unknowns.
[[nodiscard]] ErrorMap errorMap(const CameraState& state, const Eigen::MatrixXd& covariance,
                                const CameraObservations& observations);

/// Residual of a spacing, and its place [m].
struct SpacingAt {
  optics::Place place;
  double residual = 0;
};

/// Adds the mean spacing residuals around each place.
void addSpacings(ErrorMap& map, const std::vector<SpacingAt>& spacings,
                 const CameraObservations& observations);

}  // namespace lab::calibration
