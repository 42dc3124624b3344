/// What a projector's calibration says to people.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "projector_ctl/calibration/projector_fit.hpp"

namespace lab::calibration {

/// Residuals in mm by place, where they are worst, and how good it is in cm.
[[nodiscard]] std::string projectorReport(const ProjectorFit& fit, const ProjectorPlane& plane);

/// A grey picture, the top row first.
struct ResidualPicture {
  int columns = 0;
  int rows = 0;
  double scale = 0;  ///< [1] by which the arrows are longer than the residuals
  std::vector<std::uint8_t> grey;
};

/// The residual field as arrows over the arena, x right, y up, a mesh of 10 cm: from where light is
/// wanted to where it falls. The longest arrow is 5 cm long.
[[nodiscard]] ResidualPicture residualPicture(const ProjectorFit& fit, const ProjectorPlane& plane);

}  // namespace lab::calibration
