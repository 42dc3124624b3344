/// A projector's lens from structured light: how good it is, where, and whether it will do. Numbers
/// in, numbers out.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "projector_ctl/calibration/projector_lens.hpp"

namespace lab::calibration {

/// What makes a fit a calibration.
struct ProjectorFitLimits {
  int observations = 200;      ///< at least
  double residual = 1e-3;      ///< [m] rms at most
  double outlying = 0.25;      ///< share of the sights at most
  double covered = 0.9;        ///< share of the arena at least
  double dark_corner = 0.005;  ///< [m] from a corner's both walls: what must be lit
};

/// One square of the arena.
struct SquareResidual {
  double x = 0;           ///< [m] its middle
  double y = 0;           ///< [m]
  double residual_x = 0;  ///< [m] light found less light wanted, mean of the sights in it
  double residual_y = 0;  ///< [m]
  double sigma = 0;       ///< [m] standard error of the mean along each axis
  int observations = 0;
};

struct ProjectorFit {
  optics::CameraParameters lens;
  int observations = 0;  ///< used
  int outlying = 0;      ///< left out, as they fit to nothing: shadows, glare
  double residual = 0;   ///< [m] rms of the sights: found less fitted place
  double noise = 0;      ///< [m] rms of that part of it that differs from sight to sight
  double misfit = 0;     ///< [m] rms over the arena of that part that squares have in common: what
                         ///< the lens model does not describe
  double statistical = 0;  ///< [m] rms standard error over the arena of the fitted lens
  double camera = 0;       ///< [m] rms error of the camera's own calibration, 0: not known
  double accuracy = 0;  ///< [m] rms of where light falls: misfit, statistical and camera together
  double covered = 0;   ///< [1] share of the squares with sights
  std::vector<SquareResidual> squares;  ///< row by row from (0, 0)
  int columns = 0;                      ///< of squares
  std::size_t worst = 0;                ///< index of the square that misses most
  std::string refusal;                  ///< not empty: why this is no calibration

  /// [m] by which the worst square misses.
  [[nodiscard]] double worstResidual() const;
};

/// Bundle of all sights: pinhole with k1, k2, p1, p2, Huber's weights; the noise is estimated from
/// the residuals, and sights that miss by more than five standard deviations and 0.3 mm are left
/// out.
/// @param camera_error [m] rms, of the camera's own calibration; 0: not known, and not contained
[[nodiscard]] ProjectorFit fitProjector(const std::vector<ProjectorObservation>& observations,
                                        const ProjectorPlane& plane, double camera_error = 0,
                                        const ProjectorFitLimits& limits = {});

}  // namespace lab::calibration
