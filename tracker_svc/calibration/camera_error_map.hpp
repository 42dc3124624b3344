/// What a fitted camera means for positions on the cap plane. Used by camera_fit only.
#pragma once

#include <optional>
#include <vector>

#include "light/optics/bundle_adjustment.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"

namespace lab::calibration {

/// Measured less known spacing of a cap [m]; empty where the camera cannot see it.
[[nodiscard]] std::optional<double> spacingResidual(const optics::CameraModel& model,
                                                    const optics::CapGeometry& cap,
                                                    const CapObservation& observation);

/// Standard deviation of the measured spacing [m] that the sigma of its circles makes.
[[nodiscard]] std::optional<double> spacingSigma(const optics::CameraModel& model,
                                                 const optics::CapGeometry& cap,
                                                 const CapObservation& observation);

/// Standard errors of positions over the arena, for a covariance of the camera's unknowns.
[[nodiscard]] ErrorMap errorMap(const CameraState& state, const Eigen::MatrixXd& covariance,
                                const CameraObservations& observations);

/// By how much a spacing was missed, and where [m].
struct SpacingAt {
  optics::Place place;
  double miss = 0;
};

/// Fills in the means of the spacings about each place.
void addSpacings(ErrorMap& map, const std::vector<SpacingAt>& spacings,
                 const CameraObservations& observations);

}  // namespace lab::calibration
