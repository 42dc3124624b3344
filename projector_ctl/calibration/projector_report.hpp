/// Report of a projector calibration for users.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "projector_ctl/calibration/projector_fit.hpp"

namespace lab::calibration {

/// Residuals in mm by place, the worst place, and the accuracy in cm.
[[nodiscard]] std::string projectorReport(const ProjectorFit& fit, const ProjectorPlane& plane);

/// A grey picture, the top row first.
struct ResidualPicture {
  int columns = 0;
  int rows = 0;
  double scale = 0;  ///< [1] length of the arrows relative to the residuals
  std::vector<std::uint8_t> grey;
};

/// The residuals as arrows over the arena (x right, y up, grid of 10 cm), from the wanted to the
/// actual place of the light. The longest arrow is 5 cm long.
[[nodiscard]] ResidualPicture residualPicture(const ProjectorFit& fit, const ProjectorPlane& plane);

}  // namespace lab::calibration
